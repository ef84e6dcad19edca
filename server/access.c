#include "server/access.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/options.h"
#include "ecofiles/base/options_file.h"

/* ---- Tokens ---- */

static bool is_token_byte(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')
		|| (c && strchr("-._~+/=", c));
}

static enum eco_code read_token(uint8_t token[SRV_TOKEN_BYTES_MAX], const char *path, struct eco_error *error)
{
	char line[SRV_TOKEN_BYTES_MAX + 3] = "";
	FILE *file;
	ECO_PASS(eco_open_regular(&file, path, "a token", error));
	bool has_line = fgets(line, sizeof line, file);
	fclose(file);
	size_t size = strcspn(line, "\r\n");
	line[size] = 0;
	bool good = has_line && size >= SRV_TOKEN_BYTES_LEAST && size <= SRV_TOKEN_BYTES_MAX;
	for (size_t i = 0; i < size; i++)
		good = good && is_token_byte(line[i]);
	if (!good)
		return eco_fail(error, ECO_BAD_INPUT,
			"%s: its first line is not a token: %u to %u letters, digits or "
			"any of -._~+/=, as `openssl rand -hex 32` makes",
			path, SRV_TOKEN_BYTES_LEAST, SRV_TOKEN_BYTES_MAX);
	memset(token, 0, SRV_TOKEN_BYTES_MAX);
	memcpy(token, line, size);
	return ECO_OK;
}

/* `scene`: a valid name, or "". */
static enum eco_code add_token(struct srv_access *access, const char *scene, const char *path,
	struct eco_error *error)
{
	struct srv_token *token = &access->tokens[access->token_count];
	if (access->token_count == SRV_TOKENS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "more than %u tokens; serve the other scenes by "
			"another ecoserve", SRV_TOKENS_MAX);
	ECO_PASS(read_token(token->bytes, path, error));
	memcpy(token->scene, scene, strlen(scene) + 1);
	access->token_count++;
	return ECO_OK;
}

enum eco_code srv_access_add_operator(const char *file, void *access, struct eco_error *error)
{
	return add_token(access, "", file, error);
}

enum eco_code srv_access_add_token(const char *argument, void *access, struct eco_error *error)
{
	char scene[SRV_NAME_BYTES + 1] = "";
	size_t size = strcspn(argument, "=");
	memcpy(scene, argument, size < SRV_NAME_BYTES ? size : SRV_NAME_BYTES);
	if (!argument[size] || !srv_name_valid(scene))
		return eco_fail(error, ECO_BAD_USAGE, "--token %.100s: must be SCENE=FILE", argument);
	return add_token(access, scene, argument + size + 1, error);
}

/* All of both is looked at, whatever they are. */
static bool same_token(const uint8_t a[SRV_TOKEN_BYTES_MAX], const uint8_t b[SRV_TOKEN_BYTES_MAX])
{
	volatile uint8_t differs = 0;
	for (uint32_t i = 0; i < SRV_TOKEN_BYTES_MAX; i++)
		differs |= a[i] ^ b[i];
	return !differs;
}

/* "Bearer TOKEN"; none is all zeros, which no token is. */
static void read_bearer(uint8_t token[SRV_TOKEN_BYTES_MAX], const char *authorization)
{
	static const char scheme[] = "Bearer ";
	memset(token, 0, SRV_TOKEN_BYTES_MAX);
	if (!authorization || strncasecmp(authorization, scheme, sizeof scheme - 1) != 0)
		return;
	const char *text = authorization + sizeof scheme - 1;
	text += strspn(text, " ");
	size_t size = strlen(text);
	if (size <= SRV_TOKEN_BYTES_MAX)
		memcpy(token, text, size);
}

/* `scene` "": the operator's alone. */
static bool holds_token(const struct srv_access *access, const char *scene, const char *authorization)
{
	uint8_t given[SRV_TOKEN_BYTES_MAX];
	bool holds = false;
	read_bearer(given, authorization);
	for (uint32_t i = 0; i < access->token_count; i++) {
		const struct srv_token *token = &access->tokens[i];
		bool counts = !token->scene[0] || strcmp(token->scene, scene) == 0;
		holds |= same_token(token->bytes, given) & counts;
	}
	return holds;
}

bool srv_access_is_private(const struct srv_access *access, const char *scene)
{
	for (uint32_t i = 0; i < access->token_count; i++)
		if (strcmp(access->tokens[i].scene, scene) == 0)
			return true;
	return false;
}

/* A scene of the same file that had a token, where this one has none; or NULL. */
static const struct srv_scene *opened_scene(const struct srv_access *access, const struct srv_scene *scene,
	const struct srv_store *before)
{
	const char *path = before ? scene->file.path : NULL;
	const struct srv_scene *old = path && !srv_store_find_file(before, scene->name, path, false)
		? srv_store_find_file(before, NULL, path, false) : NULL;
	return old && srv_access_is_private(access, old->name) && !srv_access_is_private(access, scene->name) ? old : NULL;
}

static bool is_known(const char *scene, const struct srv_store *store, const struct srv_sources *sources)
{
	return !scene[0] || srv_store_find(store, scene) || srv_sources_name(sources, scene);
}

static enum eco_code check_caps(const struct srv_cap_list *list, const char *option, const struct srv_store
	*store, const struct srv_sources *sources, struct eco_error *error)
{
	for (uint32_t i = 0; i < list->count; i++)
		if (!is_known(list->items[i].scene, store, sources))
			return eco_fail(error, ECO_BAD_USAGE, "--%s %s=%llu: there is no scene of this name",
				option, list->items[i].scene, (unsigned long long)list->items[i].most);
	return ECO_OK;
}

enum eco_code srv_access_check(const struct srv_access *access, const struct srv_store *store,
	const struct srv_sources *sources, const struct srv_store *before, struct eco_error *error)
{
	for (uint32_t i = 0; i < access->token_count; i++)
		if (!is_known(access->tokens[i].scene, store, sources))
			return eco_fail(error, ECO_BAD_USAGE, "--token %s=FILE: there is no scene of this "
				"name, and under another name it would be served without a token: name its "
				"pack, %s=OUT.eco", access->tokens[i].scene, access->tokens[i].scene);
	for (uint32_t i = 0; i < store->count; i++) {
		const struct srv_scene *old = opened_scene(access, store->scenes[i], before);
		if (old)
			return eco_fail(error, ECO_BAD_USAGE, "%s was scene '%s', which has a token, and "
				"is now '%s', which has none: name it, %s=OUT.eco, or give the other a token",
				old->file.path, old->name, store->scenes[i]->name, old->name);
	}
	enum eco_code code = check_caps(&access->vertices, "cap-vertices", store, sources, error);
	return code ? code : check_caps(&access->bytes, "cap-bytes", store, sources, error);
}

bool srv_access_has_private(const struct srv_access *access)
{
	for (uint32_t i = 0; i < access->token_count; i++)
		if (access->tokens[i].scene[0])
			return true;
	return false;
}

bool srv_access_scene(const struct srv_access *access, const char *scene, const char *authorization)
{
	return !srv_access_is_private(access, scene) || holds_token(access, scene, authorization);
}

/* ---- Origins ---- */

static enum eco_code check_origin(const char *option, const char *origin, struct eco_error *error)
{
	const char *scheme = strncmp(origin, "https://", 8) == 0 ? origin + 8
		: strncmp(origin, "http://", 7) == 0 ? origin + 7 : NULL;
	bool good = strcmp(origin, "*") == 0 || (scheme && *scheme);
	for (const char *at = scheme; at && *at; at++)
		good = good && (is_token_byte(*at) || strchr(":[]", *at)) && *at != '/';
	return good ? ECO_OK : eco_fail(error, ECO_BAD_USAGE, "--%s %.100s: must be * or an origin in the "
		"form that browsers send: https://HOST[:PORT], without a path", option, origin);
}

enum eco_code srv_access_add_frame(const char *origin, void *to, struct eco_error *error)
{
	struct srv_access *access = to;
	size_t used = strlen(access->frames);
	ECO_PASS(check_origin("embed", origin, error));
	if (used + strlen(origin) + 2 > sizeof access->frames)
		return eco_fail(error, ECO_TOO_LARGE, "--embed: more than %u bytes of origins",
			SRV_FRAMES_BYTES);
	snprintf(access->frames + used, sizeof access->frames - used, " %s", origin);
	return ECO_OK;
}

enum eco_code srv_access_add_origin(const char *origin, void *to, struct eco_error *error)
{
	struct srv_access *access = to;
	ECO_PASS(check_origin("cors", origin, error));
	if (access->origin_count == SRV_ORIGINS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "--cors: more than %u origins", SRV_ORIGINS_MAX);
	access->origins[access->origin_count++] = origin;
	return ECO_OK;
}

bool srv_access_origins_vary(const struct srv_access *access)
{
	return access->origin_count > 1 && !srv_access_origin(access, NULL);
}

const char *srv_access_origin(const struct srv_access *access, const char *origin)
{
	const char *found = NULL;
	for (uint32_t i = 0; i < access->origin_count; i++) {
		if (strcmp(access->origins[i], "*") == 0)
			return "*";
		if (access->origin_count == 1 || (origin && strcmp(access->origins[i], origin) == 0))
			found = access->origins[i];
	}
	return found;
}

/* ---- Caps ---- */

static enum eco_code add_cap(struct srv_cap_list *list, const char *argument, enum eco_option_kind kind,
	const char *option, struct eco_error *error)
{
	struct srv_cap cap = { .most = 0 };
	const char *end;
	const char *equals = strchr(argument, '='), *number = equals ? equals + 1 : argument;
	size_t size = equals ? (size_t)(equals - argument) : 0;
	if (size < sizeof cap.scene)
		memcpy(cap.scene, argument, size);
	if ((equals && !srv_name_valid(cap.scene)) || !eco_count_read(number, kind, &cap.most, &end) ||
		*end || !cap.most)
		return eco_fail(error, ECO_BAD_USAGE,
			"--%s %.100s: must be N or SCENE=N, N a whole number above 0, "
			"perhaps with k, M or G behind it, as in 64M",
			option, argument);
	if (list->count == SRV_CAPS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "more than %u caps: --%s; one without SCENE= is for "
			"all", SRV_CAPS_MAX, option);
	list->items[list->count++] = cap;
	return ECO_OK;
}

enum eco_code srv_cap_add_vertices(const char *argument, void *list, struct eco_error *error)
{
	return add_cap(list, argument, ECO_OPTION_COUNT, "cap-vertices", error);
}

enum eco_code srv_cap_add_bytes(const char *argument, void *list, struct eco_error *error)
{
	return add_cap(list, argument, ECO_OPTION_BYTES, "cap-bytes", error);
}

static uint64_t most_of(const struct srv_cap_list *list, const char *scene)
{
	uint64_t all = UINT64_MAX, own = 0;
	for (uint32_t i = 0; i < list->count; i++)
		if (!list->items[i].scene[0])
			all = list->items[i].most;
		else if (strcmp(list->items[i].scene, scene) == 0)
			own = list->items[i].most;
	return own ? own : all;
}

struct srv_most srv_caps_of(const struct srv_access *access, const char *scene)
{
	return (struct srv_most){ most_of(&access->vertices, scene), most_of(&access->bytes, scene) };
}
