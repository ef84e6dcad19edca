/* JSON for a page, bit by bit; the writer's `failed` is looked at once, at the end. */
#ifndef WEB_TEXT_H
#define WEB_TEXT_H

#include "client-min/view_select.h"
#include "ecofiles/base/bytes.h"

extern const char *const web_role_names[VIEW_ROLE_COUNT];

/* At most 255 bytes at a time. */
void web_say(struct eco_writer *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A string, with its quotes: UTF-8 stays as it is. */
void web_say_name(struct eco_writer *text, const char *name);

#endif
