/* The viewer's files (make web), read whole at start, so that no request reaches a file system. Each has its
 * compressed forms NAME.gz and NAME.br beside it. The file `version` names the content of all of them: the
 * page's addresses have it (/viewer/VERSION/NAME), so that browsers keep files for good. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define SRV_SITE_FILES_MAX 32u
#define SRV_SITE_NAME_BYTES 48u
#define SRV_SITE_INDEX "index.html"      /* what / is */
#define SRV_SITE_ICON "icon.svg"         /* what /favicon.ico leads to */
#define SRV_SITE_VERSION "version"       /* the file of one line: lower-case hex digits */
#define SRV_SITE_VERSION_BYTES 65u

/* The page at / without a viewer. */
extern const char srv_site_missing[];

enum srv_form { SRV_FORM_PLAIN, SRV_FORM_GZIP, SRV_FORM_BROTLI, SRV_FORM_COUNT };
extern const char *const srv_form_names[SRV_FORM_COUNT];         /* of Content-Encoding; plain: NULL */

struct srv_site_file {
	char name[SRV_SITE_NAME_BYTES];
	const char *type;                        /* of its content */
	struct { uint8_t *bytes; size_t size; } forms[SRV_FORM_COUNT];   /* NULL: there is none */
};
struct srv_site {                        /* owns its bytes */
	struct srv_site_file files[SRV_SITE_FILES_MAX];
	uint32_t count;
	char version[SRV_SITE_VERSION_BYTES];    /* "": none is known */
};

/* Reads DIR, whose files have names and extensions that are known. A folder that is not there is an empty
 * site. */
enum eco_code srv_site_read(struct srv_site *site, const char *dir, struct eco_error *error);
/* Reads DIR, which has to have a page; NULL: where `make web` or `make install` put the viewer
 * (ECO_VIEWER_INSTALLED, from the Makefile), or an empty site. */
enum eco_code srv_site_open(struct srv_site *site, const char *dir, struct eco_error *error);
void srv_site_free(struct srv_site *site);
const struct srv_site_file *srv_site_find(const struct srv_site *site, const char *name);       /* or NULL */

/* The form that takes least bytes of those that an Accept-Encoding header (NULL: none) takes. */
enum srv_form srv_site_form(const struct srv_site_file *file, const char *accept_encoding);
