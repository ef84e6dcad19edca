/* The kind of a file, before a reader of models sees it, and files that models name. The commonest
 * mistakes (a packed file, a pointer of Git LFS, a scene of an editor, a point cloud) are known by their
 * first bytes or their name, and each has a sentence of its own: the readers would only say that they do
 * not understand. */
#include "build/words/other_files.table"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/model/import_model.h"

#include <dirent.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEAD_BYTES 65536u

/* ---- Names ---- */

bool eco_path_ends_with(const char *path, const char *extension)
{
	size_t length = strlen(path), ending = strlen(extension);
	return length > ending && strcasecmp(path + length - ending, extension) == 0;
}

/* Undoes percent-escapes and turns backslashes, as exporters on other systems write them. */
static void plain_path(char *text)
{
	char *to = text;
	for (char *from = text; *from != 0; from++) {
		unsigned code;
		if (*from == '%' && from[1] != 0 && from[2] != 0 && sscanf(from + 1, "%2x", &code) == 1
				&& code >= 0x20) {
			*to++ = (char)code;
			from += 2;
		} else {
			*to++ = *from == '\\' ? '/' : *from;
		}
	}
	*to = 0;
}

/* The entry of that name in any case; of several, the first in order. */
static bool find_any_case(const char *folder, const char *name, char *path, size_t size)
{
	DIR *open = opendir(*folder != 0 ? folder : ".");
	const struct dirent *entry;
	char found[sizeof entry->d_name] = "";
	while (open && (entry = readdir(open)))
		if (strcasecmp(entry->d_name, name) == 0
				&& (found[0] == 0 || strcmp(entry->d_name, found) < 0))
			snprintf(found, sizeof found, "%s", entry->d_name);
	if (open)
		closedir(open);
	return found[0] != 0 && snprintf(path, size, "%s%s", folder, found) < (int)size && access(path, R_OK)
		== 0;
}

static bool is_there(char *path, size_t size, const char *folder, const char *name)
{
	struct stat status;
	return snprintf(path, size, "%s%s", folder, name) < (int)size && stat(path, &status) == 0
		&& S_ISREG(status.st_mode) && access(path, R_OK) == 0;
}

bool eco_model_find_beside(const char *model, const char *name, char *path, size_t size)
{
	const char *slash = strrchr(model, '/'), *last;
	char plain[1024], folder[4096];
	if (snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - model) + 1 : 0, model)
		>= (int)sizeof folder || snprintf(plain, sizeof plain, "%s", name) >= (int)sizeof plain)
		return false;
	if (is_there(path, size, *name != '/' ? folder : "",
			name))      /* a percent sign or backslash may be meant as such */
		return true;
	plain_path(plain);
	last = eco_path_last(plain);
	if (*plain != '/' && !strchr(plain, ':') && is_there(path, size, folder, plain))
		return true;
	return is_there(path, size, folder, last) || find_any_case(folder, last, path, size);
}

/* ---- Bytes ---- */

char *eco_file_read_head(const char *path, size_t *size)
{
	char *head = eco_alloc(HEAD_BYTES + 1, 1);
	FILE *file = fopen(path, "rb");
	*size = file ? fread(head, 1, HEAD_BYTES, file) : 0;
	if (file)
		fclose(file);
	return head;
}

bool eco_file_head_has(const char *path, size_t bytes, const char *word)
{
	size_t size;
	char *head = eco_file_read_head(path, &size);
	bool has = head && memmem(head, size < bytes ? size : bytes, word, strlen(word));
	free(head);
	return has;
}

/* ---- Files that are no models ---- */

/* suffix: if the name lacks it, the command needs its other form */
struct packed { const char *magic; size_t bytes; const char *what, *command, *suffix, *otherwise; };

static const struct packed packed[] = {
	{ "\xfd" "7zXZ\0", 6, "xz", "xz -dk", ".xz", "xzcat" },
		{ "\x1f\x8b", 2, "gzip", "gunzip -k", ".gz", "zcat" },
	{ "BZh", 3, "bzip2", "bunzip2 -k", ".bz2", "bzcat" },
	{ "\x28\xb5\x2f\xfd", 4, "zstd", "zstd -d", ".zst", "zstdcat" },
	{ "7z\xbc\xaf\x27\x1c", 6, "7z", "7z x", "", "" }, { "Rar!\x1a\x07", 6, "rar", "unrar x", "", "" },
	{ "PK\x03\x04", 4, "zip", "unzip", "", "" },
};

static enum eco_code refuse_packed(const char *path, const struct packed *p, struct eco_error *error)
{
	const char *name = eco_path_last(path);
	if (eco_path_ends_with(path, p->suffix))
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: packed with %s; unpack it first: %s %.100s",
			path, p->what, p->command, name);
	return eco_fail(error, ECO_UNSUPPORTED, "%.300s: packed with %s; unpack it first: %s <%.100s "
		">unpacked-%.100s", path, p->what, p->otherwise, name, name);
}

enum eco_code eco_file_check_head(const char *path, const char *head, size_t size, bool holds_zip,
	const char *wanted, struct eco_error *error)
{
	if (size == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: the file is empty", path);
	for (size_t i = 0; i < sizeof packed / sizeof *packed; i++)
		if (size >= packed[i].bytes && memcmp(head, packed[i].magic, packed[i].bytes) == 0
				&& !(holds_zip && packed[i].magic[0] == 'P'))
			return refuse_packed(path, &packed[i], error);
	if (size >= 22 && memcmp(head, "version https://git-lfs", 22) == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: a pointer of Git LFS, not the file itself: "
			"git lfs pull fetches it", path);
	while (size > 0 && (*head == ' ' || *head == '\t' || *head == '\n' || *head == '\r')) {
		head++;
		size--;
	}
	if (strncasecmp(head, "<!doctype html", 14) == 0 || strncasecmp(head, "<html", 5) == 0)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: a web page, not %s: the download went wrong",
			path, wanted);
	return ECO_OK;
}

enum eco_code eco_model_file_check(const char *path, struct eco_error *error)
{
	struct stat status;
	bool holds_zip = eco_path_ends_with(path, ".zae") || eco_path_ends_with(path, ".3mf")
		|| eco_path_ends_with(path, ".usdz");
	size_t size;
	if (stat(path, &status) != 0)
		return eco_fail_read(error, path, errno);
	if (S_ISDIR(status.st_mode))
		return eco_fail(error, ECO_BAD_INPUT, "%.400s: a folder, not a model", path);
	if (!S_ISREG(status.st_mode))
		return eco_fail(error, ECO_IO, "%.400s: not a regular file", path);
	if (access(path, R_OK) != 0)
		return eco_fail_read(error, path, errno);
	char *head = eco_file_read_head(path, &size);
	enum eco_code code = eco_file_check_head(path, head, size, holds_zip, "a model", error);
	free(head);
	const char *dot = strrchr(eco_path_last(path), '.');
	char extension[16];
	if (dot)
		snprintf(extension, sizeof extension, "|%.10s|", dot);
	for (size_t i = 0; code == ECO_OK && i < sizeof other_files_rows / sizeof *other_files_rows; i++)
		if (dot && strcasestr(other_files_rows[i].extensions, extension))
			code = eco_fail(error, ECO_UNSUPPORTED, "%.300s: %s", path, other_files_rows[i].says);
	return code;
}

/* ---- Notes ---- */

void eco_note(struct eco_notes *notes, const char *format, ...)
{
	va_list arguments;
	size_t left = sizeof notes->text - notes->used;
	va_start(arguments, format);
	int wanted = vsnprintf(notes->text + notes->used, left, format, arguments);
	va_end(arguments);
	if (wanted < 0 || (size_t)wanted + 2 > left) {
		notes->text[notes->used] = 0;
		return;
	}
	notes->used += (size_t)wanted;
	notes->text[notes->used++] = '\n';
	notes->text[notes->used] = 0;
}

void eco_notes_tell(struct eco_notes *notes, void (*warn)(void *ctx, const char *text), void *ctx)
{
	char *rest = notes->text, *line;
	notes->text[sizeof notes->text - 1] = 0;
	while (warn && (line = strsep(&rest, "\n")))
		if (*line != 0)
			warn(ctx, line);
}

/* ---- Texts ---- */

size_t eco_text_space(const char *text)
{
	const unsigned char *t = (const unsigned char *)text;
	if (t[0] == ' ' || (t[0] >= '\t' && t[0] <= '\r'))
		return 1;
	if (t[0] == 0xc2 && t[1] == 0xa0)
		return 2;
	if (t[0] == 0xe2 && t[1] == 0x80 && ((t[2] >= 0x80 && t[2] <= 0x8a) || t[2] == 0xaf))
		return 3;
	return 0;
}

const char *eco_text_skip_spaces(const char *text)
{
	size_t bytes;
	while ((bytes = eco_text_space(text)) > 0)
		text += bytes;
	return text;
}

/* The small letter of a code point with two UTF-8 bytes, in blocks whose capitals lie at a fixed distance
 * or at even numbers. */
static unsigned small_letter(unsigned c)
{
	if ((c >= 0xc0 && c <= 0xde && c != 0xd7) || (c >= 0x391 && c <= 0x3a9) || (c >= 0x410 && c <= 0x42f))
		return c + 0x20;
	if (c >= 0x400 && c <= 0x40f)
		return c + 0x50;
	if ((c >= 0x100 && c <= 0x137 && c != 0x130) || (c >= 0x14a && c <= 0x177))
		return c | 1;
	if ((c >= 0x139 && c <= 0x148) || (c >= 0x179 && c <= 0x17e))
		return c + (c & 1);
	return c == 0x178 ? 0xff : c;
}

size_t eco_text_fold(const char *text, char *folded, size_t size)
{
	size_t used = 0;
	bool gap = false;
	for (text = eco_text_skip_spaces(text); *text != 0 && used + 1 < size;) {
		size_t space = eco_text_space(text);
		unsigned char c = (unsigned char)*text, next = (unsigned char)text[1];
		if (space > 0) {
			gap = true;
			text += space;
			continue;
		}
		if (gap && used + 2 < size)
			folded[used++] = ' ';
		gap = false;
		if (c >= 0xc3 && c <= 0xdf && (next & 0xc0) == 0x80) {
			unsigned letter = small_letter((c & 0x1fu) << 6 | (next & 0x3fu));
			if (used + 2 >= size)
				break;
			folded[used++] = (char)(0xc0 | letter >> 6);
			folded[used++] = (char)(0x80 | (letter & 0x3f));
			text += 2;
			continue;
		}
		if (c == 0xef && (next == 0xbc || next == 0xbd) && text[2] != 0) {       /* wide signs: "１２ｍ" */
			unsigned sign = (unsigned char)text[2] - (next == 0xbc ? 0x60u : 0x20u);
			c = sign > 0x20 && sign < 0x7f ? (unsigned char)sign : c;
			text += c < 0x80 ? 2 : 0;
		}
		folded[used++] = (char)(c >= 'A' && c <= 'Z' ? c + 32 : c);
		text++;
	}
	folded[used] = 0;
	return used;
}

bool eco_text_fits(const char *text, const char *pattern, char one)
{
	const char *star = NULL, *from = NULL;
	while (*text != 0) {
		if (*pattern == '*') {
			star = pattern++;
			from = text;
		} else if (*pattern != 0 && (*pattern == *text || *pattern == one)) {
			size_t bytes = *pattern++ == one ? eco_utf8_bytes(text, strlen(text)) : 1;
			text += bytes > 0 ? bytes : 1;
		} else if (star) {
			pattern = star + 1;
			text = ++from;
		} else {
			return false;
		}
	}
	while (*pattern == '*')
		pattern++;
	return *pattern == 0;
}
