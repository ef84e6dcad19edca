/* JSON for a page, bit by bit; the writer's `failed` is looked at once, at the end. */
#ifndef WEB_TEXT_H
#define WEB_TEXT_H

#include "client-min/view_select.h"
#include "ecofiles/base/bytes.h"

/* A string, with its quotes: UTF-8 stays as it is. */
void web_say_name(struct eco_writer *text, const char *name);

#endif
