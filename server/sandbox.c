#include "server/sandbox.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/confine.h"

/* As long as the process: what may be read, and what may be written. */
static char **folders;
static uint32_t folder_count;
static const char *copies[2];

static bool is_folder(const char *path)
{
	struct stat about;
	return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

/* A folder that is not there holds a pack that is not there. */
static enum eco_code add_folder(const char *path, size_t size, struct eco_error *error)
{
	char *folder = strndup(size ? path : ".", size ? size : 1);
	if (folder && !is_folder(folder)) {
		free(folder);
		return ECO_OK;
	}
	for (uint32_t i = 0; folder && i < folder_count; i++)
		if (strcmp(folders[i], folder) == 0) {
			free(folder);
			return ECO_OK;
		}
	char **grown = folder ? realloc(folders, (folder_count + 2) * sizeof *grown) : NULL;
	if (!grown) {
		free(folder);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the names of folders");
	}
	folders = grown;
	folders[folder_count++] = folder;
	folders[folder_count] = NULL;
	return ECO_OK;
}

/* The folder part of a path, up to its last slash: "/" for the root, "." without a slash. */
static enum eco_code add_folder_of(const char *path, struct eco_error *error)
{
	const char *slash = strrchr(path, '/');
	return add_folder(path, slash ? (size_t)(slash - path) + (slash == path) : 0, error);
}

/* The folder of a pack, and that of the file that its name links to. */
static enum eco_code add_folders_of(const char *path, struct eco_error *error)
{
	char *real = realpath(path, NULL);
	enum eco_code code = add_folder_of(path, error);
	if (!code && real)
		code = add_folder_of(real, error);
	free(real);
	return code;
}

static enum eco_code list_folders(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	char name[SRV_NAME_BYTES + 1];
	for (uint32_t i = 0; i < sandbox->sources->count && !code; i++) {
		const char *path = srv_source_path(sandbox->sources->arguments[i], name);
		code = is_folder(path) ? add_folder(path, strlen(path), error) : add_folders_of(path, error);
	}
	for (uint32_t i = 0; i < sandbox->store->count && !code; i++)
		code = add_folders_of(sandbox->store->scenes[i]->file.path, error);
	copies[0] = sandbox->sources->copies;
	return code;
}

/* A part that this system does not have. */
static enum eco_code lack(const struct srv_sandbox *sandbox, enum eco_code code, const struct eco_error *why,
	const char *so, struct eco_error *error)
{
	if (code == ECO_UNSUPPORTED && !sandbox->required) {
		srv_log_event(sandbox->log_form, true, "warning: %s; %s", why->text, so);
		return ECO_OK;
	}
	return eco_fail(error, code, "%s%s", why->text, code == ECO_UNSUPPORTED
		? " (--require-sandbox)" : "");
}

static enum eco_code become_user(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	struct eco_error why = { 0 };
	enum eco_code code = srv_user_become(sandbox->user, &why);
	if (code && sandbox->user->was_asked_for)
		return eco_fail(error, code, "--user: %s", why.text);
	return code ? lack(sandbox, code, &why, "it serves as root", error) : ECO_OK;
}

static enum eco_code confine(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	struct eco_error why = { 0 };
	const struct eco_confined_paths paths = { .readable = (const char *const *)folders,
		.writable = copies, .without_libraries = true };
	enum eco_code code = eco_confine(&paths, &why);
	return code ? lack(sandbox, code, &why, "it may read whatever its user may", error) : ECO_OK;
}

static enum eco_code filter_calls(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	struct eco_error why = { 0 };
	enum eco_code code = srv_sandbox_filter(&why);
	return code ? lack(sandbox, code, &why, "it may call whatever its user may", error) : ECO_OK;
}

enum eco_code srv_sandbox_enter(const struct srv_sandbox *sandbox, struct eco_error *error)
{
	enum eco_code code = list_folders(sandbox, error);
	code = code ? code : become_user(sandbox, error);
	code = code ? code : confine(sandbox, error);
	if (!code && sandbox->user->changes)
		code = srv_user_settle(eco_is_confined(), (const char *const *)folders, copies, error);
	return code ? code : filter_calls(sandbox, error);
}
