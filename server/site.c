#include "server/site.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/files.h"
#include "ecofiles/base/module.h"
#include "ecofiles/base/options_file.h"

#define FILE_BYTES_MAX (16u << 20)

const char *const srv_form_names[SRV_FORM_COUNT] = { NULL, "gzip", "br" };

const char srv_site_missing[] =
	"<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
	"<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
	"<meta name=\"color-scheme\" content=\"light dark\">\n<title>ecoserve: no viewer</title>\n"
	"<h1>This server has no viewer</h1>\n"
	"<p>The viewer shows scenes in a browser. It is built apart from ecoserve: run <code>make web</code> "
	"in the source tree of ecostream, some minutes, once, and start ecoserve again. It finds the viewer in "
	"<code>web/site</code> beside itself, or in the folder of <code>ecoserve --viewer DIR</code>.</p>\n"
	"<p>Scenes are served without it: <a href=\"v1/scenes\">v1/scenes</a> lists them, and "
	"<code>ecoview</code> draws them.</p>\n</html>\n";

static const struct { const char *extension, *type; } types[] = {
	{ ".html", "text/html; charset=utf-8" }, { ".css", "text/css; charset=utf-8" },
	{ ".js", "text/javascript; charset=utf-8" }, { ".mjs", "text/javascript; charset=utf-8" },
	{ ".wasm", "application/wasm" }, { ".svg", "image/svg+xml" } };

static bool ends_with(const char *name, const char *end)
{
	size_t size = strlen(name), tail = strlen(end);
	return size > tail && strcmp(name + size - tail, end) == 0;
}

static const char *type_of(const char *name)
{
	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (ends_with(name, types[i].extension))
			return types[i].type;
	return NULL;
}

/* ---- Reading ---- */

static enum eco_code read_whole(const char *path, uint8_t **bytes, size_t *size, struct eco_error *error)
{
	FILE *file;
	enum eco_code code = eco_open_regular(&file, path, "the viewer", error);
	if (file)
		fclose(file);
	return code ? code : eco_file_read(path, FILE_BYTES_MAX, bytes, size, error);
}

static enum eco_code read_file(struct srv_site *site, const char *dir, const char *name,
	struct eco_error *error)
{
	static const char *const ends[SRV_FORM_COUNT] = { "", ".gz", ".br" };
	const char *type = type_of(name);
	char path[4096];
	if (!type || strlen(name) >= SRV_SITE_NAME_BYTES || site->count == SRV_SITE_FILES_MAX)
		return eco_fail(error, ECO_BAD_INPUT, "%s/%s: no file of the viewer; let `make web` make "
			"this folder", dir, name);
	struct srv_site_file *file = &site->files[site->count++];
	snprintf(file->name, sizeof file->name, "%s", name);
	file->type = type;
	for (int form = 0; form < SRV_FORM_COUNT; form++) {
		snprintf(path, sizeof path, "%s/%s%s", dir, name, ends[form]);
		ECO_PASS(read_whole(path, &file->forms[form].bytes, &file->forms[form].size, error));
	}
	return ECO_OK;
}

static enum eco_code read_version(struct srv_site *site, const char *dir, struct eco_error *error)
{
	char path[4096];
	uint8_t *bytes = NULL;
	size_t size = 0;
	snprintf(path, sizeof path, "%s/%s", dir, SRV_SITE_VERSION);
	enum eco_code code = read_whole(path, &bytes, &size, error);
	size_t digits = 0;
	while (digits < size && memchr("0123456789abcdef", bytes[digits], 16))
		digits++;
	bool line = digits + 1 == size && bytes[digits] == '\n';
	if (!code && line && digits > 0 && digits < SRV_SITE_VERSION_BYTES)
		memcpy(site->version, bytes, digits);
	else if (!code)
		code = eco_fail(error, ECO_BAD_INPUT, "%s: one line of at most %u lower-case hex digits is "
			"expected; let `make web` make this folder", path, SRV_SITE_VERSION_BYTES - 1);
	free(bytes);
	return code;
}

/* Compressed forms are read with what they are forms of. */
static enum eco_code read_entry(struct srv_site *site, const char *dir, const char *name,
	struct eco_error *error)
{
	if (name[0] == '.' || ends_with(name, ".gz") || ends_with(name, ".br"))
		return ECO_OK;
	return strcmp(name, SRV_SITE_VERSION) == 0 ? read_version(site, dir, error)
		: read_file(site, dir, name, error);
}

enum eco_code srv_site_read(struct srv_site *site, const char *dir, struct eco_error *error)
{
	*site = (struct srv_site){ .count = 0 };
	DIR *folder = opendir(dir);
	if (!folder)
		return errno == ENOENT ? ECO_OK : eco_fail_read(error, dir, errno);
	enum eco_code code = ECO_OK;
	for (const struct dirent *entry; !code && (entry = readdir(folder));)
		code = read_entry(site, dir, entry->d_name, error);
	closedir(folder);
	if (code)
		srv_site_free(site);
	return code;
}

enum eco_code srv_site_open(struct srv_site *site, const char *dir, struct eco_error *error)
{
	static const char *const places[] = { "/web/site", "/" ECO_VIEWER_INSTALLED, NULL };
	char path[PATH_MAX];
	*site = (struct srv_site){ .count = 0 };
	if (!dir)
		return eco_data_path(places, "", path) ? srv_site_read(site, path, error) : ECO_OK;
	enum eco_code code = srv_site_read(site, dir, error);
	return code || srv_site_find(site, SRV_SITE_INDEX) ? code : eco_fail(error, ECO_NOT_FOUND,
		"--viewer %s: no viewer there; `make web` makes one", dir);
}

void srv_site_free(struct srv_site *site)
{
	for (uint32_t i = 0; i < site->count; i++)
		for (int form = 0; form < SRV_FORM_COUNT; form++)
			free(site->files[i].forms[form].bytes);
	*site = (struct srv_site){ .count = 0 };
}

/* ---- Looking ---- */

const struct srv_site_file *srv_site_find(const struct srv_site *site, const char *name)
{
	for (uint32_t i = 0; i < site->count; i++)
		if (strcmp(site->files[i].name, name) == 0)
			return &site->files[i];
	return NULL;
}

/* Whether a list such as "gzip, br;q=0.9" names a coding, and not to refuse it (RFC 9110, 12.5.3). */
static bool accepts(const char *list, const char *coding)
{
	size_t size = strlen(coding);
	while (list && *list) {
		list += strspn(list, " \t,");
		size_t item = strcspn(list, ",");
		if (item >= size && strncasecmp(list, coding, size) == 0
				&& (item == size || strchr(" \t;", list[size]))) {
			const char *q = strstr(list, "q=");
			return !q || q > list + item || strtod(q + 2, NULL) > 0;
		}
		list += item;
	}
	return false;
}

enum srv_form srv_site_form(const struct srv_site_file *file, const char *accept_encoding)
{
	enum srv_form best = SRV_FORM_PLAIN;
	for (enum srv_form form = SRV_FORM_GZIP; form < SRV_FORM_COUNT; form++)
		if (file->forms[form].size < file->forms[best].size
				&& accepts(accept_encoding, srv_form_names[form]))
			best = form;
	return best;
}
