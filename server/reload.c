#include "server/store.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/confine.h"

#define PATH_BYTES 4096

struct loading {
	const struct srv_store *before;  /* NULL: the first time */
	struct srv_store *store;
	struct srv_reload *report;
	struct eco_error first;          /* of the first pack that is not well */
};

static void say_why(struct srv_reload *report, const char *text)
{
	size_t used = strlen(report->why);
	snprintf(report->why + used, sizeof report->why - used, "%s%s", used ? "; " : "", text);
}

/* Folders that were named since by a link, for instance, are not among those of the start (sandbox.h). */
static void say_confined(struct eco_error *why, const char *path)
{
	char *real = realpath(path, NULL);
	const char *advice = eco_advice_read(EACCES);        /* no right would help */
	size_t used = strlen(why->text), size = strlen(advice);
	used -= used >= size && !strcmp(why->text + used - size, advice) ? size : 0;
	if (real && !eco_confined_may_read(path))
		snprintf(why->text + used, sizeof why->text - used, ": %s is outside the folders that the "
			"sandbox of this server allows: move the pack into one of them, or start ecoserve "
			"again", real);
	free(real);
}

/* Something is not well. The scene of the same file stays, if there is one. */
static enum eco_code keep(struct loading *loading, const char *name, const char *path,
	struct eco_error *why, struct eco_error *error)
{
	say_confined(why, path);
	struct srv_scene *old = loading->before
		? srv_store_find_file(loading->before, name, path, false) : NULL;
	say_why(loading->report, why->text);
	eco_fail(&loading->first, why->code, "%s", why->text);
	loading->report->bad++;
	return old ? srv_store_share(loading->store, old, error) : ECO_OK;
}

/* The other packs cannot be well, either, or nobody would know which of two is meant. */
static bool stops(const struct loading *loading, enum eco_code code)
{
	return code == ECO_NO_MEMORY || code == ECO_INTERRUPTED || (code == ECO_BAD_USAGE && !loading->before);
}

/* `name` NULL: as the pack or its file is named. */
static enum eco_code load_pack(struct loading *loading, const char *name, const char *path,
	struct eco_error *error)
{
	struct eco_error why = { 0 };
	struct srv_scene *same = loading->before ? srv_store_find_file(loading->before, name, path, true)
		: NULL;
	enum eco_code code = same ? srv_store_share(loading->store, same, &why)
		: srv_store_add(loading->store, name, path, &why);
	if (!code) {
		++*(same ? &loading->report->same : &loading->report->opened);
		return ECO_OK;
	}
	return stops(loading, code) ? eco_fail(error, code, "%s", why.text)
		: keep(loading, name, path, &why, error);
}

static int is_pack(const struct dirent *entry)
{
	size_t size = strlen(entry->d_name);
	return size > 4 && entry->d_name[0] != '.' && strcmp(entry->d_name + size - 4, ".eco") == 0;
}

static enum eco_code load_folder(struct loading *loading, const char *folder, struct eco_error *error)
{
	struct dirent **entries;
	char path[PATH_BYTES];
	enum eco_code code = ECO_OK;
	int count = scandir(folder, &entries, is_pack, alphasort);
	struct eco_error why = { 0 };
	if (count < 0 && (eco_fail_read(&why, folder, errno), loading->before))
		return eco_fail(error, why.code, "%s", why.text);
	if (count < 0)
		return keep(loading, NULL, folder, &why, error);
	for (int i = 0; i < count; i++) {
		snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
		code = code ? code : load_pack(loading, NULL, path, error);
		free(entries[i]);
	}
	free(entries);
	return code;
}

/* "NAME=FILE" or "FILE"; a '=' behind a '/' belongs to the file. */
const char *srv_source_path(const char *argument, char name[SRV_NAME_BYTES + 1])
{
	const char *equals = strchr(argument, '='), *slash = strchr(argument, '/');
	name[0] = 0;
	if (!equals || (slash && slash < equals))
		return argument;
	snprintf(name, SRV_NAME_BYTES + 1, "%.*s", (int)(equals - argument), argument);
	return equals + 1;
}

bool srv_sources_name(const struct srv_sources *sources, const char *scene)
{
	char name[SRV_NAME_BYTES + 1];
	for (uint32_t i = 0; i < sources->count; i++)
		if (srv_source_path(sources->arguments[i], name) && strcmp(name, scene) == 0)
			return true;
	return false;
}

static enum eco_code load_argument(struct loading *loading, const char *argument, struct eco_error *error)
{
	char name[SRV_NAME_BYTES + 1];
	struct stat about;
	const char *path = srv_source_path(argument, name);
	bool has_name = path != argument;
	return !has_name && stat(path, &about) == 0 && S_ISDIR(about.st_mode)
		? load_folder(loading, path, error) : load_pack(loading, has_name ? name : NULL, path, error);
}

static uint32_t count_gone(const struct srv_store *before, const struct srv_store *store)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < before->count; i++)
		count += !srv_store_find(store, before->scenes[i]->name);
	return count;
}

enum eco_code srv_sources_load(const struct srv_sources *sources, const struct srv_store *before,
	struct srv_store *store, struct srv_reload *report, struct eco_error *error)
{
	struct loading loading = { before, store, report, { 0 } };
	enum eco_code code = ECO_OK;
	srv_store_init(store);
	store->copies = sources->copies;
	store->cancelled = sources->cancelled;
	*report = (struct srv_reload){ 0 };
	for (uint32_t i = 0; i < sources->count && !code; i++)
		code = load_argument(&loading, sources->arguments[i], error);
	if (!code && !store->count && loading.first.code)
		code = eco_fail(error, loading.first.code, "%s", loading.first.text);
	else if (!code && !store->count)
		code = eco_fail(error, ECO_NOT_FOUND,
			"there is no pack: no OUT.eco in the folders that are named");
	report->gone = code || !before ? 0 : count_gone(before, store);
	return code;
}
