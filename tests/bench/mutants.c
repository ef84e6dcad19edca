/* Damaged models: `ecopack make`'s import must read or refuse each within its limits, and leave this process
 * as it was.
 *
 *   mutants [--count N] [--seed S] [--only I] --folder DIR MODEL...
 *
 * Makes N mutants (1000) of the models in turn: flipped bits, runs of other bytes, cut ends, pieces repeated,
 * left out or moved (bytes or whole lines), extreme numbers in texts and in fields of 16, 32 and 64 bits.
 * Mutant I depends on S and I alone; --only I makes that one and keeps it in DIR, where the models'
 * neighbours (textures, MTL) are linked. Prints a table, and for each crash of a child the options that
 * repeat it. Exit 1 if a child outlived its limits, or children, descriptors or memory are left behind. A
 * crash of this process names the mutant. */
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <malloc.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client-min/view_store.h"
#include "ecofiles/base/guard.h"
#include "ecofiles/base/random.h"
#include "ecofiles/format/image.h"
#include "ecofiles/import/model/model_import.h"
#include "tests/support/files.h"

#define MODELS_MAX 64
#ifdef __SANITIZE_ADDRESS__
#define GROWTH_MAX_KB LONG_MAX       /* freed memory stays in quarantine; leaks are found otherwise */
#else
#define GROWTH_MAX_KB (32 << 10)     /* caches that fill once; what leaks at each import is more */
#endif
#define WARM 50                      /* mutants before memory is measured first */
#define SLACK_S 5

struct bytes { uint8_t *at; size_t size; };
struct model {
	const char *path, *extension;
	struct bytes bytes;
	uint32_t mutants, imported, refused, limited, crashed, hung;
	double slowest_s;
};
#define SECONDS 5                    /* of the processor that an import may take */
struct options { uint64_t count, seed, only; const char *folder; };

/* ---- Chance ---- */

static uint64_t state;

static uint64_t bits(void)
{
	return eco_random_next(&state);
}

static size_t below(size_t most) { return most == 0 ? 0 : (size_t)(bits() % most); }

/* Short pieces as likely as long ones, up to half of it. */
static size_t some_length(size_t size)
{
	size_t length = (size_t)1 << below(18);
	length = length / 2 + below(length / 2 + 1) + 1;
	return length > size / 2 ? size / 2 : length;
}

/* ---- Mutations: in place, or in a new block ---- */

static void flip_bits(struct bytes *b)
{
	for (size_t i = 1 + below(8); i-- > 0;)
		b->at[below(b->size)] ^= (uint8_t)(1u << below(8));
}

static void overwrite(struct bytes *b)
{
	size_t length = 1 + below(64), at = below(b->size);
	int value = below(2) ? -1 : below(2) ? 0 : below(2) ? 255 : ' ';
	for (size_t i = at; i < b->size && i < at + length; i++)
		b->at[i] = (uint8_t)(value < 0 ? bits() : (unsigned)value);
}

static void cut_end(struct bytes *b)
{
	b->size = below(4) == 0 ? below(b->size) : b->size - 1 - below(b->size < 4096 ? b->size - 1 : 4096);
}

static size_t line_start(const struct bytes *b, size_t at)
{
	while (at > 0 && b->at[at - 1] != '\n')
		at--;
	return at;
}

/* Takes [from, from + length) and puts it, so often, before `to`. */
static void splice(struct bytes *b, size_t from, size_t length, size_t to, unsigned times, bool keep)
{
	size_t rest = keep ? b->size : b->size - length;
	uint8_t *made = malloc(rest + times * length + 1), *at = made;
	for (size_t i = 0; i <= b->size; i++) {
		if (i == to)
			for (unsigned k = 0; k < times; k++, at += length)
				memcpy(at, b->at + from, length);
		if (i < b->size && (keep || i < from || i >= from + length))
			*at++ = b->at[i];
	}
	free(b->at);
	b->at = made;
	b->size = (size_t)(at - made);
}

static void move_piece(struct bytes *b)
{
	size_t length = some_length(b->size), from = below(b->size - length), to = below(b->size);
	if (below(2)) {              /* whole lines, where there are lines */
		size_t start = line_start(b, from), end = line_start(b, from + length);
		if (end > start && end - start < b->size) {
			from = start;
			length = end - start;
			to = line_start(b, to);
		}
	}
	switch (below(3)) {
	case 0: splice(b, from, length, to, 0, false); break;
	case 1: splice(b, from, length, to, 1 + (unsigned)below(3), true); break;
	default: splice(b, from, length, to, 1, false); break;
	}
}

/* A number as text becomes another one, of any length. */
static void replace_number(struct bytes *b)
{
	static const char *const extremes[] = { "0", "-1", "1", "-0", "nan", "inf", "-inf", "1e38", "-1e38",
		"1e39", "1e308", "1e999", "1e-45",
		"2147483647", "-2147483648", "2147483648", "4294967295", "4294967296", "9223372036854775807",
		"18446744073709551616", "65535",
		"65536", "255", "256", "0x7fffffff", "1.5", "-1.5", "1e5", "1000000000", "", "//", "1/",
		"null", "99999999999999999999999999999" };
	size_t at = below(b->size), end;
	while (at < b->size && !isdigit(b->at[at]))
		at++;
	while (at > 0 && at < b->size && (isdigit(b->at[at - 1]) || strchr("+-.eE", b->at[at - 1]))
			&& b->at[at - 1])
		at--;
	for (end = at; end < b->size && b->at[end] && (isdigit(b->at[end]) || strchr("+-.eE", b->at[end]));)
		end++;
	const char *with = extremes[below(sizeof extremes / sizeof *extremes)];
	size_t length = strlen(with), size = b->size - (end - at) + length;
	uint8_t *made = malloc(size + 1);
	memcpy(made, b->at, at);
	memcpy(made + at, with, length);
	memcpy(made + at + length, b->at + end, b->size - end);
	free(b->at);
	*b = (struct bytes){ made, size };
}

/* The length stays, and so does whatever depends on it. */
static void change_digits(struct bytes *b)
{
	for (size_t i = 1 + below(4); i-- > 0;) {
		size_t at = below(b->size);
		while (at < b->size && !isdigit(b->at[at]))
			at++;
		if (at < b->size)
			b->at[at] = (uint8_t)"0123456789-.e"[below(13)];
	}
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

/* Headers are small and decide much: half of the damage is in the first kilobytes, if need be. */
static struct bytes mutate(const struct model *m)
{
	static void (*const mutations[])(struct bytes *) = { flip_bits, overwrite, cut_end, move_piece,
		replace_number, change_digits, replace_field, replace_field };
	struct bytes b = { malloc(m->bytes.size + 1), m->bytes.size };
	memcpy(b.at, m->bytes.at, b.size);
	for (size_t i = 1 + below(4) * below(2); i-- > 0 && b.size > 16;) {
		void (*mutation)(struct bytes *) = mutations[below(8)];
		size_t whole = b.size;
		bool in_place = mutation != cut_end && mutation != move_piece && mutation != replace_number;
		if (in_place && below(2) && whole > 4096)
			b.size = 64u << below(6);
		mutation(&b);
		if (in_place)
			b.size = whole;
	}
	return b;
}

/* ---- Files ---- */

static _Noreturn void stop(const char *what, const char *path)
{
	fprintf(stderr, "mutants: %s: %s: %s\n", path, what, strerror(errno));
	exit(2);
}

/* Links the files that the model names beside its mutants, too. */
static void link_neighbours(const char *path, const char *folder)
{
	char home[PATH_MAX], from[2 * PATH_MAX], to[2 * PATH_MAX], *slash;
	struct dirent *entry;
	if (!realpath(path, home) || !(slash = strrchr(home, '/')))
		stop("cannot be found", path);
	*slash = 0;
	DIR *list = opendir(home);
	while (list && (entry = readdir(list))) {
		snprintf(from, sizeof from, "%s/%s", home, entry->d_name);
		snprintf(to, sizeof to, "%s/%s", folder, entry->d_name);
		if (entry->d_name[0] != '.' && symlink(from, to) != 0 && errno != EEXIST)
			stop("cannot be linked", to);
	}
	if (list)
		closedir(list);
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

static long resident_kb(void)
{
	char line[256];
	long kb = 0;
	malloc_trim(0);
	FILE *file = fopen("/proc/self/status", "r");
	while (file && fgets(line, sizeof line, file))
		if (sscanf(line, "VmRSS: %ld", &kb) == 1)
			break;
	if (file)
		fclose(file);
	return kb;
}

static volatile unsigned long long current;

/* A sanitizer has more to say than this. */
static void confess(int number)
{
	char text[128];
	int length = snprintf(text, sizeof text, "mutants: signal %d in this process at mutant %llu (--only "
		"%llu)\n", number, current, current);
	if (write(STDERR_FILENO, text, (size_t)length) > 0) {
		signal(number, SIG_DFL);
		raise(number);
	}
	_exit(1);
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

static void try_mutant(struct model *m, uint64_t id, const struct options *o)
{
	char path[PATH_MAX];
	struct eco_model model;
	struct eco_error error = { 0 };
	current = id;
	state = o->seed * 0xD1342543DE82EF95u + id;
	struct bytes b = mutate(m);
	snprintf(path, sizeof path, "%s/mutant.%s", o->folder, m->extension);
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
	if (o->only != UINT64_MAX)
		printf("%s: %s %s, %.2f s\n", path, eco_code_name(code), error.text, took);
	else
		unlink(path);
}

static bool report(const struct model *models, uint32_t count, long before_kb, long after_kb, int open_before,
	int open_after)
{
	bool good = true;
	printf("%-32s %8s %8s %8s %8s %8s %6s %9s\n", "model", "mutants", "imported", "refused", "limits",
		"crashed", "hung", "slowest");
	for (uint32_t i = 0; i < count; i++) {
		const struct model *m = &models[i];
		const char *slash = strrchr(m->path, '/');
		printf("%-32.32s %8u %8u %8u %8u %8u %6u %7.2f s\n", slash != NULL ? slash + 1 : m->path,
			m->mutants, m->imported, m->refused, m->limited, m->crashed, m->hung, m->slowest_s);
		good = good && m->hung == 0;
	}
	bool children = waitpid(-1, NULL, WNOHANG) >= 0 || errno != ECHILD;
	printf("this process: %ld kB before, %ld kB after; %d descriptors before, %d after; %s\n", before_kb,
		after_kb, open_before, open_after, children ? "CHILDREN LEFT" : "no child left");
	return good && !children && open_before == open_after && after_kb - before_kb < GROWTH_MAX_KB;
}

/* ---- The command line ---- */

/* Returns how many models there are; 0: the command line is wrong. */
static uint32_t read_arguments(int argc, char **argv, struct options *o, struct model *models)
{
	static const struct option names[] = { { "count", required_argument, NULL, 'c' },
		{ "seed", required_argument, NULL, 'r' }, { "only", required_argument, NULL, 'o' },
		{ "folder", required_argument, NULL, 'f' }, { NULL, 0, NULL, 0 } };
	bool usable = true;
	for (int c; (c = getopt_long(argc, argv, "", names, NULL)) != -1;) {
		usable = usable && c != '?';
		o->count = c == 'c' ? strtoull(optarg, NULL, 10) : o->count;
		o->seed = c == 'r' ? strtoull(optarg, NULL, 10) : o->seed;
		o->only = c == 'o' ? strtoull(optarg, NULL, 10) : o->only;
		o->folder = c == 'f' ? optarg : o->folder;
	}
	uint32_t count = 0;
	for (; optind < argc && count < MODELS_MAX; optind++) {
		struct model *m = &models[count++];
		const char *dot = strrchr(argv[optind], '.');
		*m = (struct model){ .path = argv[optind], .extension = dot ? dot + 1 : "" };
		m->bytes.at = file_read(m->path, &m->bytes.size);
		usable = usable && m->bytes.size >= 16;
	}
	return usable && o->folder ? count : 0;
}

/* The importer takes its limits from the environment. The module for pictures is loaded once here, not in
 * each child. */
static void prepare(const struct options *o, const struct model *models, uint32_t count)
{
	static const int numbers[] = { SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL };
	uint8_t pixel[4] = { 0 }, *png = NULL;
	char text[32];
	size_t size;
	folder_make(o->folder);
	for (uint32_t i = 0; i < count; i++)
		link_neighbours(models[i].path, o->folder);
	snprintf(text, sizeof text, "%d", SECONDS);
	setenv(ECO_GUARD_SECONDS_VARIABLE, text, 1);
	setenv(ECO_GUARD_MEMORY_VARIABLE, "1", 1);
	if (eco_png_encode(&(struct eco_pixels){ 1, 1, 4, pixel }, &png, &size, NULL) == ECO_OK)
		free(png);
#ifdef __SANITIZE_ADDRESS__
	(void)numbers, (void)confess;
#else
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		signal(numbers[i], confess);
#endif
	setvbuf(stdout, NULL, _IOLBF, 0);
}

int main(int argc, char **argv)
{
	static struct model models[MODELS_MAX];
	struct options o = { .count = 1000, .seed = 1, .only = UINT64_MAX };
	uint32_t count = read_arguments(argc, argv, &o, models);
	long before_kb = 0;
	int open_before = 0;
	if (count == 0) {
		fprintf(stderr, "usage: mutants [--count N] [--seed S] [--only I] --folder DIR MODEL...\n");
		return 2;
	}
	prepare(&o, models, count);
	if (o.only != UINT64_MAX)
		return try_mutant(&models[o.only % count], o.only, &o), 0;
	for (uint64_t id = 0; id < o.count; id++) {
		if (id == (o.count < 2 * WARM ? 0 : WARM)) {
			before_kb = resident_kb();
			open_before = descriptors();
		}
		try_mutant(&models[id % count], id, &o);
	}
	return !report(models, count, before_kb, resident_kb(), open_before, descriptors());
}
