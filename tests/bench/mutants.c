/* Damaged models: `ecopack make`'s import must read or refuse each within its limits, and leave this process
 * as it was.
 *
 *   mutants [--count N] [--seed S] [--only I] MODEL...
 *
 * Makes N mutants (1000) of the models in turn, each as mutant.EXTENSION beside its model: flipped bits, runs
 * of other bytes, cut ends, pieces repeated, left out or moved (bytes or whole lines), extreme numbers in
 * texts and in fields of 16, 32 and 64 bits. Mutant I depends on S and I alone; --only I makes that one and
 * keeps it. Prints a table, and for each crash of a child the options that repeat it. Exit 1 if a child
 * outlived its limits, or children or descriptors are left behind; sanitizers find memory that is. */
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client-min/view_store.h"
#include "ecofiles/base/guard.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/format/image.h"
#include "ecofiles/import/model/model_import.h"
#include "tests/support/files.h"

#define MODELS_MAX 64
#define SECONDS 5                    /* of the processor that an import may take */
#define SLACK_S 5

struct bytes { uint8_t *at; size_t size; };
struct model {
	const char *path;
	struct bytes bytes;
	uint32_t mutants, imported, refused, limited, crashed, hung;
	double slowest_s;
};

/* ---- Mutations ---- */

static uint64_t state;

static size_t below(size_t most) { return most == 0 ? 0 : (size_t)(eco_random_next(&state) % most); }

static void flip_bits(struct bytes *b)
{
	for (size_t i = 1 + below(8); i-- > 0;)
		b->at[below(b->size)] ^= (uint8_t)(1u << below(8));
}

static void overwrite(struct bytes *b)
{
	size_t length = 1 + below(64), at = below(b->size), kind = below(4);
	for (size_t i = at; i < b->size && i < at + length; i++)
		b->at[i] = (uint8_t)(kind == 0 ? below(256) : kind == 1 ? 0 : kind == 2 ? 255 : ' ');
}

static void cut_end(struct bytes *b)
{
	b->size = below(4) == 0 ? below(b->size) : b->size - 1 - below(b->size < 4096 ? b->size - 1 : 4096);
}

/* Puts other bytes, which may be its own, in the place of some. */
static void splice(struct bytes *b, size_t at, size_t removed, const void *with, size_t length)
{
	struct bytes made = { eco_alloc(b->size - removed + length + 1, 1), b->size - removed + length };
	memcpy(made.at, b->at, at);
	memcpy(made.at + at, with, length);
	memcpy(made.at + at + length, b->at + at + removed, b->size - at - removed);
	free(b->at);
	*b = made;
}

static size_t line_start(const struct bytes *b, size_t at)
{
	while (at > 0 && b->at[at - 1] != '\n')
		at--;
	return at;
}

/* Short pieces are as likely as long ones, up to half of the file. */
static void move_piece(struct bytes *b)
{
	size_t length = 1 + below((size_t)1 << below(18));
	length = length > b->size / 2 ? b->size / 2 : length;
	size_t from = below(b->size - length), to = below(b->size - length);
	if (below(2)) {              /* whole lines, where there are lines */
		size_t start = line_start(b, from), end = line_start(b, from + length);
		if (end > start) {
			from = start;
			length = end - start;
			to = line_start(b, to);
		}
	}
	bool repeated = below(2);
	splice(b, to, repeated || to + length > b->size ? 0 : length, b->at + from, length);
	if (below(2))
		splice(b, from, length, "", 0);
}

static bool is_of_number(uint8_t c) { return isdigit(c) || (c && strchr("+-.eE", c)); }

/* A number as text becomes another one, of any length. */
static void replace_number(struct bytes *b)
{
	static const char *const extremes[] = { "0", "-1", "1", "-0", "nan", "inf", "-inf", "1e38", "-1e38",
		"1e39", "1e308", "1e999", "1e-45",
		"2147483647", "-2147483648", "2147483648", "4294967295", "4294967296", "9223372036854775807",
		"18446744073709551616", "65535",
		"65536", "255", "256", "0x7fffffff", "1.5", "-1.5", "1e5", "1000000000", "", "//", "1/",
		"null", "99999999999999999999999999999" };
	const char *with = extremes[below(sizeof extremes / sizeof *extremes)];
	size_t at = below(b->size), end;
	while (at < b->size && !isdigit(b->at[at]))
		at++;
	while (at > 0 && at < b->size && is_of_number(b->at[at - 1]))
		at--;
	for (end = at; end < b->size && is_of_number(b->at[end]);)
		end++;
	splice(b, at, end - at, with, strlen(with));
}

/* A field of a binary format: a count, a length, an index, an offset, a number. */
static void replace_field(struct bytes *b)
{
	static const uint32_t extremes[] = { 0, 1, 2, 0x7f, 0x80, 0xff, 0x100, 0x7fff, 0x8000, 0xffff,
		0x10000, 0xffffff, 0x1000000, 0x10000000, 0x40000000, 0x7fffffff, 0x80000000, 0xfffffff0,
		0xffffffff, 0x7fc00000, 0x7f800000, 0xff800000, 0x7f7fffff, 0x00000001 };
	size_t width = (size_t)2 << below(3), at = below(b->size);
	uint64_t value = 0;
	at -= below(4) ? at % (width < 4 ? width : 4) : 0;
	if (at + width > b->size)
		return;
	memcpy(&value, b->at + at, width);
	switch (below(5)) {
	case 0: value++; break;
	case 1: value--; break;
	case 2: value *= 2 + below(64); break;
	case 3: value = (uint64_t)extremes[below(24)] << (width == 8 && below(2) ? 32 : 0); break;
	default: value = extremes[below(24)]; break;
	}
	memcpy(b->at + at, &value, width);
}

/* Headers are small and decide much: half of the damage that keeps the length is in the first kilobytes. */
static struct bytes mutate(const struct model *m)
{
	static void (*const mutations[])(struct bytes *) = { cut_end, move_piece, replace_number, flip_bits,
		overwrite, replace_field, replace_field };
	struct bytes b = { eco_alloc(m->bytes.size + 1, 1), m->bytes.size };
	memcpy(b.at, m->bytes.at, b.size);
	for (size_t i = 1 + below(4) * below(2); i-- > 0 && b.size > 16;) {
		size_t which = below(7), whole = b.size;
		bool in_place = which > 2;
		if (in_place && below(2) && whole > 4096)
			b.size = 64u << below(6);
		mutations[which](&b);
		if (in_place)
			b.size = whole;
	}
	return b;
}

/* ---- This process ---- */

static int descriptors(void)
{
	DIR *list = opendir("/proc/self/fd");
	int count = 0;
	while (list && readdir(list))
		count++;
	if (list)
		closedir(list);
	return count;
}

/* ---- One mutant ---- */

/* Walks all that the model holds: an index out of bounds would crash here. */
static void look_at(const struct eco_model *m)
{
	volatile double sum = 0;
	for (uint32_t i = 0; i < m->triangle_count; i++)
		for (int k = 0; k < 3; k++)
			sum += m->position[3 * (size_t)m->index[3 * (size_t)i + (size_t)k]]
				+ m->materials[m->material[i]].rgb[k];
	for (uint32_t i = 0; i < m->image_count; i++)
		sum += m->images[i].rgba[(size_t)m->images[i].width * m->images[i].height * 4 - 1];
	(void)sum;
}

static void try_mutant(struct model *m, uint64_t seed, uint64_t id, bool only)
{
	char path[PATH_MAX];
	struct eco_model model;
	struct eco_error error = { 0 };
	const char *slash = strrchr(m->path, '/'), *dot = strrchr(m->path, '.');
	state = seed * 0xD1342543DE82EF95u + id;
	struct bytes b = mutate(m);
	snprintf(path, sizeof path, "%.*smutant%s", slash ? (int)(slash + 1 - m->path) : 0, m->path,
		dot ? dot : "");
	file_write(path, b.at, b.size);
	free(b.at);
	double start_ms = view_clock_ms();
	enum eco_code code = eco_model_import(&model, &(struct eco_model_options){ .paths = (const char
		*[]){ path }, .path_count = 1 }, &error);
	double took = 1e-3 * (view_clock_ms() - start_ms);
	if (!code)
		look_at(&model);
	eco_model_free(&model);
	m->mutants++;
	m->slowest_s = took > m->slowest_s ? took : m->slowest_s;
	m->hung += took > 2 * SECONDS + SLACK_S;
	bool crash = strstr(error.text, "reading it ended with") != NULL,
		limit = strstr(error.text, "ECO_IMPORT_") != NULL;
	*(code == ECO_OK ? &m->imported : crash ? &m->crashed : limit ? &m->limited : &m->refused) += 1;
	if (crash && m->crashed <= 5)
		printf("  %s, --only %llu: %s\n", m->path, (unsigned long long)id, error.text);
	if (only)
		printf("%s: %s %s, %.2f s\n", path, eco_code_name(code), error.text, took);
	else
		unlink(path);
}

/* Returns the number of mutants that outlived their limits. */
static uint32_t report(const struct model *models, uint32_t count)
{
	uint32_t hung = 0;
	printf("%-32s %8s %8s %8s %8s %8s %6s %9s\n", "model", "mutants", "imported", "refused", "limits",
		"crashed", "hung", "slowest");
	for (uint32_t i = 0; i < count; i++) {
		const struct model *m = &models[i];
		const char *slash = strrchr(m->path, '/');
		printf("%-32.32s %8u %8u %8u %8u %8u %6u %7.2f s\n", slash != NULL ? slash + 1 : m->path,
			m->mutants, m->imported, m->refused, m->limited, m->crashed, m->hung, m->slowest_s);
		hung += m->hung;
	}
	return hung;
}

int main(int argc, char **argv)
{
	static const struct option names[] = { { "count", required_argument, NULL, 'c' },
		{ "seed", required_argument, NULL, 'r' }, { "only", required_argument, NULL, 'o' },
		{ NULL, 0, NULL, 0 } };
	static struct model models[MODELS_MAX];
	uint64_t number[3] = { 1000, 1, UINT64_MAX };        /* count, seed, only */
	uint32_t count = 0;
	bool usable = true;
	for (int c; (c = getopt_long(argc, argv, "", names, NULL)) != -1;) {
		if (c == '?')
			usable = false;
		else
			number[c == 'c' ? 0 : c == 'r' ? 1 : 2] = strtoull(optarg, NULL, 10);
	}
	for (; optind < argc && count < MODELS_MAX; optind++, count++) {
		models[count].path = argv[optind];
		models[count].bytes.at = file_read(argv[optind], &models[count].bytes.size);
		usable = usable && models[count].bytes.size >= 16;
	}
	if (!usable || count == 0) {
		fprintf(stderr, "usage: mutants [--count N] [--seed S] [--only I] MODEL...\n");
		return 2;
	}
	/* the importer takes its limits from the environment */
	setenv(ECO_GUARD_SECONDS_VARIABLE, "5", 1);
	setenv(ECO_GUARD_MEMORY_VARIABLE, "1", 1);
	_Static_assert(SECONDS == 5, "as above");
	/* the module for pictures is loaded once here, not in each child */
	uint8_t pixel[4] = { 0 }, *png = NULL;
	size_t size;
	if (eco_png_encode(&(struct eco_pixels){ 1, 1, 4, pixel }, &png, &size, NULL) == ECO_OK)
		free(png);
	setvbuf(stdout, NULL, _IOLBF, 0);
	if (number[2] != UINT64_MAX)
		return try_mutant(&models[number[2] % count], number[1], number[2], true), 0;
	int open_before = 0;
	for (uint64_t id = 0; id < number[0]; id++) {
		open_before = id == count ? descriptors() : open_before;    /* what opens once is open */
		try_mutant(&models[id % count], number[1], id, false);
	}
	uint32_t hung = report(models, count);
	int left = number[0] > count ? descriptors() - open_before : 0;
	bool children = waitpid(-1, NULL, WNOHANG) >= 0 || errno != ECHILD;
	printf("this process: %d descriptors left; %s\n", left, children ? "CHILDREN LEFT" : "no child left");
	return hung || left || children;
}
