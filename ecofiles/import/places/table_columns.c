/* A column's role by the words of its name, in points, and by its content: a place or a size is made of
 * numbers, a species is a text, best one that names plants. An even selection of a table's rows shows the
 * content. Longer than 600 lines: choice, joined species, signs of numbers and rows share the table. */
#include "ecofiles/import/places/table_columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/places/flora.h"
#include "ecofiles/import/places/words.h"
#include "ecofiles/import/places/inventory_text.h"

#define NEAR_POINTS 10           /* a rival is at most so much worse */
#define CONTENT_POINTS 60
#define NUMERIC_LEAST 0.5
#define CLASS_POINTS 60          /* ages whose name says classes have fewer: they are ranges, or numbers of classes */
#define CODES_LEAST 0.9          /* texts of a column that a system of codes explains */

/* ---- Content ---- */

/* "tree_type", "nom de l'arbre": a plant's word and one for its kind. */
static int points_by_kind(const char *name)
{
	return eco_words_any(name, eco_words_set("plant")) && eco_words_any(name, eco_words_set("kind")) ? 55
		: 0;
}

/* The share of a column's filled texts, of the first rows, that are such. */
static double share(const struct eco_table *table, uint32_t column, uint32_t rows, bool (*is)(const char *,
	char),
	char decimal)
{
	uint32_t filled = 0, good = 0;
	for (uint32_t row = 0; row < table->row_count && row < rows; row++) {
		const char *text = eco_table_field(table, row, column);
		bool missing = eco_text_is_missing(text);
		filled += !missing;
		good += !missing && is(text, decimal);
	}
	return filled > 0 ? (double)good / filled : 0;
}

/* decimal 0: with either decimal sign */
static bool is_number(const char *text, char decimal)
{
	double number;
	return eco_text_number(text, decimal ? decimal : '.', &number) || (!decimal && eco_text_number(text,
		',', &number));
}

/* A number, a range, a bound. */
static bool is_size(const char *text, char decimal)
{
	double number, unit_m;
	return eco_text_size(text, decimal, &number, &unit_m) != ECO_FORM_NONE;
}

static bool is_range(const char *text, char decimal)
{
	double number, unit_m;
	enum eco_size_form form = eco_text_size(text, decimal, &number, &unit_m);
	return form == ECO_FORM_RANGE || form == ECO_FORM_OPEN;
}

static bool is_year(const char *text, char decimal)
{
	(void)decimal;
	return !isnan(eco_text_year(text));
}

static bool is_of_plants(const char *text, char decimal)
{
	(void)decimal;
	struct eco_flora flora = eco_flora_of(text, NULL);
	return flora.genus || flora.form == ECO_FORM_NOTHING || eco_flora_has_code("letters", text);
}

/* The share of a column's texts that one system of codes explains. */
static double codes_share(const struct eco_table *table, uint32_t column)
{
	const char *system;
	double best = 0;
	for (size_t i = 0; (system = eco_flora_system(i)) != NULL; i++) {
		uint32_t filled = 0, good = 0;
		for (uint32_t row = 0; row < table->row_count && row < 128; row++) {
			const char *text = eco_table_field(table, row, column);
			if (eco_text_is_missing(text))
				continue;
			filled++;
			good += eco_flora_has_code(system, text);
		}
		best = filled > 0 && (double)good / filled > best ? (double)good / filled : best;
	}
	return best;
}

static double plants_share(const struct eco_table *table, uint32_t column)
{
	return share(table, column, 256, is_of_plants, 0);
}

/* How surely a column names species: by its name, and as many of its texts do. Numbers are codes of a system. */
static int species_points(const struct eco_table *table, uint32_t column, char decimal)
{
	const char *name = table->columns[column];
	int by_name = eco_column_points(ECO_ROLE_SPECIES, name), by_kind = points_by_kind(name);
	bool text = share(table, column, UINT32_MAX, is_number, decimal) < NUMERIC_LEAST;
	double plants = text ? plants_share(table, column) : 0;
	if (by_name > 0 && plants < NUMERIC_LEAST) {
		double codes = codes_share(table, column);
		plants = codes >= CODES_LEAST && codes > plants ? codes : plants;
	}
	if (!text && plants < CODES_LEAST)
		return 0;
	return (by_kind > by_name ? by_kind : by_name) + (int)lround(CONTENT_POINTS * plants);
}

static int points(const struct eco_table *table, enum eco_role role, uint32_t column, char decimal)
{
	if (role == ECO_ROLE_SPECIES)
		return species_points(table, column, decimal);
	int sum = eco_column_points(role, table->columns[column]);
	if (sum <= 0 || role == ECO_ROLE_PLOT)
		return sum;
	if (role == ECO_ROLE_AGE && sum < CLASS_POINTS && share(table, column, UINT32_MAX, is_range, decimal) < NUMERIC_LEAST)
		return 0;
	bool place = role == ECO_ROLE_X || role == ECO_ROLE_Y;
	if (role == ECO_ROLE_PLANTED)
		return share(table, column, UINT32_MAX, is_year, decimal) >= NUMERIC_LEAST ? sum : 0;
	return share(table, column, UINT32_MAX, place ? is_number : is_size, place ? 0
		: decimal) >= NUMERIC_LEAST ? sum : 0;
}

/* ---- Choice ---- */

static uint32_t filled(const struct eco_table *t, uint32_t column)
{
	uint32_t count = 0;
	for (uint32_t row = 0; row < t->row_count; row++)
		count += !eco_text_is_missing(eco_table_field(t, row, column));
	return count;
}

/* Maps of volunteers have many columns of species, most of them nearly empty: those that say it in less than
 * a quarter as many rows as another are left aside. */
static uint32_t least_filled(const struct eco_table *t, enum eco_role role, char decimal)
{
	uint32_t most = 0;
	for (uint32_t i = 0; role == ECO_ROLE_SPECIES && i < t->column_count; i++)
		if (points(t, role, i, decimal) >= ECO_COLUMN_ENOUGH && filled(t, i) > most)
			most = filled(t, i);
	return most / 4;
}

static void choose(const struct eco_table *t, struct eco_columns *columns, enum eco_role role)
{
	int best = 0, second = 0;
	uint32_t rival = ECO_NONE;
	if (columns->of[role] != ECO_NONE)
		return;
	uint32_t least = least_filled(t, role, columns->decimal);
	for (uint32_t i = 0; i < t->column_count; i++) {
		int own = least > 0 && filled(t, i) < least ? 0 : points(t, role, i, columns->decimal);
		if (own > best) {
			second = best;
			rival = columns->of[role];
			best = own;
			columns->of[role] = i;
		} else if (own > second) {
			second = own;
			rival = i;
		}
	}
	if (best < ECO_COLUMN_ENOUGH)
		columns->of[role] = ECO_NONE;
	else if (second >= ECO_COLUMN_ENOUGH && second + NEAR_POINTS > best)
		columns->rival[role] = rival;
}

static bool is_small_word(const char *text, char decimal)
{
	(void)decimal;
	return text[0] >= 'a' && text[0] <= 'z' && !strchr(text, ' ');
}

/* Words in small letters alone, as the second names of species are. */
static bool are_epithets(const struct eco_table *t, uint32_t column)
{
	return share(t, column, UINT32_MAX, is_small_word, 0) > 0.8 && plants_share(t, column) < 0.5;
}

static bool is_genus_alone(const char *text, char decimal)
{
	(void)decimal;
	struct eco_flora flora = eco_flora_of(text, NULL);
	return flora.genus && strncasecmp(text, flora.genus, strlen(flora.genus)) == 0;
}

#define JOINED_ROWS 256u

/* The share of rows in which a second column's text names the genus's species, or a third's a cultivar that
 * grows otherwise. */
static double joined_share(const struct eco_table *t, const uint32_t *columns, uint32_t count)
{
	uint32_t filled = 0, good = 0;
	for (uint32_t row = 0; row < t->row_count && row < JOINED_ROWS; row++) {
		char text[ECO_WORDS_BYTES] = "";
		for (uint32_t i = 0; i + 1 < count; i++)
			eco_text_join(text, sizeof text, eco_table_field(t, row, columns[i]));
		struct eco_flora before = eco_flora_of(text, NULL), flora;
		eco_text_join(text, sizeof text, eco_table_field(t, row, columns[count - 1]));
		flora = eco_flora_of(text, NULL);
		filled += before.genus != NULL;
		good += before.genus && flora.genus == before.genus && (count == 2
			? before.epithet[0] == 0 && eco_flora_has_epithet(flora.genus, flora.epithet)
			: flora.form != before.form);
	}
	return filled > 0 ? (double)good / filled : 0;
}

static uint32_t best_joined(const struct eco_table *t, uint32_t species, uint32_t epithet, double least)
{
	uint32_t best = ECO_NONE, columns[3] = { species, epithet, 0 };
	uint32_t last = epithet == ECO_NONE ? 1 : 2;
	for (uint32_t i = 0; i < t->column_count; i++) {
		columns[last] = i;
		double own = i == species || i == epithet ? 0 : joined_share(t, columns, last + 1);
		if (own > least) {
			best = i;
			least = own;
		}
	}
	return best;
}

/* Epithets say nothing without the genus beside them, and the genus alone says less than both. */
static void join_species(const struct eco_table *t, struct eco_columns *columns)
{
	uint32_t *species = &columns->of[ECO_ROLE_SPECIES], *more = columns->species_more;
	for (uint32_t i = 0; *species != ECO_NONE && are_epithets(t, *species) && i < t->column_count; i++)
		if (eco_words_any(t->columns[i], eco_words_set("genus")) && !are_epithets(t, i)
				&& plants_share(t, i) > 0.5) {
			more[0] = *species;
			*species = i;
			break;
		}
	if (*species != ECO_NONE && more[0] == ECO_NONE && share(t, *species, 256, is_genus_alone, 0) > 0.5)
		more[0] = best_joined(t, *species, ECO_NONE, 0.3);
	if (*species == ECO_NONE)
		return;
	uint32_t cultivar = ECO_NONE;
	for (uint32_t i = 0; i < t->column_count; i++)
		if (eco_words_any(t->columns[i], eco_words_set("cultivar")) && i != *species && i != more[0])
			cultivar = i;
	uint32_t all[3] = { *species, more[0], cultivar };
	if (more[0] == ECO_NONE)
		all[1] = cultivar;
	if (cultivar != ECO_NONE && joined_share(t, all, more[0] == ECO_NONE ? 2 : 3) > 0)
		more[more[0] == ECO_NONE ? 0 : 1] = cultivar;
}

static bool is_form(const char *text, char decimal)
{
	(void)decimal;
	enum eco_leaf leaf;
	enum eco_form form = eco_form_of(text, &leaf);
	return form != ECO_FORM_UNKNOWN && form != ECO_FORM_NOTHING;
}

/* A column of forms of growth where none names species: leaf_type. */
static void choose_forms(const struct eco_table *t, struct eco_columns *columns)
{
	uint32_t *species = &columns->of[ECO_ROLE_SPECIES];
	for (uint32_t i = 0; i < t->column_count && *species == ECO_NONE; i++)
		if (eco_words_any(t->columns[i], eco_words_set("growth")) && share(t, i, UINT32_MAX, is_form, 0) >= NUMERIC_LEAST)
			*species = i;
}

/* Two names that differ in the axis alone. */
static bool are_pair(const char *x, const char *y)
{
	size_t head = 0, tail = 0, nx = strlen(x), ny = strlen(y);
	while (x[head] != 0 && x[head] == y[head])
		head++;
	while (tail < nx - head && tail < ny - head && x[nx - 1 - tail] == y[ny - 1 - tail])
		tail++;
	return nx == ny && nx - head - tail <= 1;
}

/* x and y go together: of the pairs, the one with most points. */
static void choose_place(const struct eco_table *t, struct eco_columns *columns)
{
	int best = 0;
	bool x_given = columns->of[ECO_ROLE_X] != ECO_NONE, y_given = columns->of[ECO_ROLE_Y] != ECO_NONE;
	uint32_t given[2] = { columns->of[ECO_ROLE_X], columns->of[ECO_ROLE_Y] };
	for (uint32_t x = 0; x < t->column_count && !(x_given && y_given); x++)
		for (uint32_t y = 0; y < t->column_count; y++) {
			if (x == y || (x_given && x != given[0]) || (y_given && y != given[1]))
				continue;
			int px = x_given ? ECO_COLUMN_ENOUGH : points(t, ECO_ROLE_X, x, columns->decimal);
			int py = y_given ? ECO_COLUMN_ENOUGH : points(t, ECO_ROLE_Y, y, columns->decimal);
			int sum = px + py + (are_pair(t->columns[x], t->columns[y]) ? 5 : 0);
			if (px < 30 || py < 30 || sum <= best)
				continue;
			best = sum;
			columns->of[ECO_ROLE_X] = x;
			columns->of[ECO_ROLE_Y] = y;
		}
}

/* Decimal commas: a column of numbers that has them, and reads as no number otherwise. */
static char find_decimal(const struct eco_table *t)
{
	uint32_t commas = 0, points_seen = 0;
	for (uint32_t row = 0; row < t->row_count; row++)
		for (uint32_t i = 0; i < t->column_count; i++) {
			const char *text = eco_table_field(t, row, i);
			double number;
			if (!strpbrk(text, ".,"))
				continue;
			bool point = eco_text_number(text, '.', &number);
			commas += !point && eco_text_number(text, ',', &number);
			points_seen += point;
		}
	return commas > points_seen ? ',' : '.';
}

bool eco_columns_are_local(const struct eco_table *table, const struct eco_columns *columns)
{
	for (int k = 0; k < 2; k++) {
		char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
		const char *at = words;
		if (columns->of[k] == ECO_NONE)
			return false;
		eco_words_of(table->columns[columns->of[k]], words, sizeof words);
		if (!eco_words_next(&at, word) || !eco_words_have(eco_words_set(k ? "quadrat y"
			: "quadrat x"), word))
			return false;
	}
	return true;
}

static bool say_degrees(const struct eco_table *table, const struct eco_columns *columns)
{
	for (int k = 0; k < 2; k++)
		if (columns->of[k] == ECO_NONE || !eco_column_says_degrees(table->columns[columns->of[k]]))
			return false;
	return true;
}

/* How x and y use a sign: alone before three digits (short: below 100,000), surely between groups, or
 * otherwise. */
struct groups { uint32_t filled, lone, short_ones, sure, other; };

static void count_groups(const struct eco_table *t, uint32_t column, char sign, struct groups *g)
{
	for (uint32_t row = 0; row < t->row_count; row++) {
		const char *text = eco_table_field(t, row, column), *first = strchr(text, sign);
		double number;
		g->filled += !eco_text_is_missing(text);
		if (first && !eco_text_grouped(text, sign, &number))
			g->other++;
		else if (first && (strchr(first + 1, sign) || strchr(text, sign == ',' ? '.' : ',')))
			g->sure++;
		else if (first) {
			g->lone++;
			g->short_ones += fabs(number) < 1e5;
		}
	}
}

/* Numbers of the other columns with this decimal sign. */
static bool others_have(const struct eco_table *t, const struct eco_columns *columns, char decimal)
{
	for (uint32_t row = 0; row < t->row_count; row++)
		for (uint32_t i = 0; i < t->column_count; i++) {
			const char *text = eco_table_field(t, row, i);
			double number, grouped;
			if (i != columns->of[ECO_ROLE_X] && i != columns->of[ECO_ROLE_Y]
					&& strchr(text, decimal) && eco_text_number(text, decimal, &number)
					&& !eco_text_grouped(text, decimal, &grouped))
				return true;
		}
	return false;
}

/* A lone sign before three digits parts thousands where other coordinates show that it does; a comma also
 * where decimals are said, or seen in other columns, to have a point. */
static void find_thousands(const struct eco_table *t, struct eco_columns *columns, char said)
{
	for (int i = 0; i < 2; i++) {
		const char sign = ",."[i], decimal = ".,"[i];
		struct groups g = { 0 };
		if (said == sign)
			continue;
		count_groups(t, columns->of[ECO_ROLE_X], sign, &g);
		count_groups(t, columns->of[ECO_ROLE_Y], sign, &g);
		if (g.lone == 0 || g.other > 0)
			continue;
		bool grid = sign == ',' && g.lone == g.filled && g.short_ones == 0
			&& !columns->names_say_degrees;
		bool point = said || (others_have(t, columns, '.') && !others_have(t, columns, ','));
		if (g.sure > 0 || (grid && point)) {
			columns->thousands = sign;
			columns->decimal = decimal;
			return;
		}
		columns->thousands_open = grid && !others_have(t, columns, ',');
	}
}

void eco_table_columns(const struct eco_table *table, struct eco_columns *columns)
{
	const char said = columns->decimal;
	const bool species_said = columns->of[ECO_ROLE_SPECIES] != ECO_NONE;
	if (columns->decimal == 0)
		columns->decimal = find_decimal(table);
	for (int role = 0; role < ECO_ROLE_COUNT; role++)
		columns->rival[role] = ECO_NONE;
	if (!table->has_geometry || columns->of[ECO_ROLE_X] != ECO_NONE)
		choose_place(table, columns);
	columns->names_say_degrees = say_degrees(table, columns);
	if (columns->of[ECO_ROLE_X] != ECO_NONE && columns->of[ECO_ROLE_Y] != ECO_NONE)
		find_thousands(table, columns, said);
	for (int role = ECO_ROLE_SPECIES; role < ECO_ROLE_COUNT; role++)
		choose(table, columns, (enum eco_role)role);
	columns->species_more[0] = columns->species_more[1] = ECO_NONE;
	if (!species_said)
		join_species(table, columns);
	choose_forms(table, columns);
}

static bool is_plant(const struct eco_table *table, uint32_t row, uint32_t species)
{
	return species == ECO_NONE
		|| eco_flora_of(eco_table_field(table, row, species), NULL).form != ECO_FORM_NOTHING;
}

void eco_table_spread(const struct eco_table *table, uint32_t column, const struct eco_columns *columns,
	struct eco_spread *spread, double *own_unit)
{
	uint64_t sizes = 0, with_unit = 0;
	for (uint32_t row = 0; row < table->row_count; row++) {
		double number, unit_m;
		const char *text = eco_table_field(table, row, column);
		if (eco_text_width(text, columns->decimal, &number, &unit_m) == ECO_FORM_NONE || !(number > 0)
				|| !is_plant(table, row, columns->of[ECO_ROLE_SPECIES]))
			continue;
		sizes++;
		with_unit += unit_m != 0;
		if (unit_m == 0)                 /* a value with its own unit says nothing about the others */
			eco_spread_add(spread, number);
	}
	*own_unit = sizes > 0 ? (double)with_unit / (double)sizes : 0;
}

void eco_table_coordinates(const struct eco_table *table, uint32_t column, const struct eco_columns *columns,
	struct eco_spread *spread)
{
	for (uint32_t row = 0; row < table->row_count; row++) {
		const char *text = eco_table_field(table, row, column);
		double number;
		if ((columns->thousands && eco_text_grouped(text, columns->thousands, &number))
				|| eco_text_number(text, columns->decimal, &number))
			eco_spread_add(spread, number);
	}
}

/* ---- Rows, and the different values of a column ---- */

static void drop_row(struct eco_table *t, uint32_t row)
{
	for (uint32_t i = 0; i < t->column_count; i++)
		free(t->fields[(size_t)row * t->column_count + i]);
}

/* Every second row leaves. */
static void thin(struct eco_table *t)
{
	for (uint32_t row = 0; row < t->row_count; row++) {
		if (row % 2 == 1) {
			drop_row(t, row);
			continue;
		}
		memmove(t->fields + (size_t)(row / 2) * t->column_count,
			t->fields + (size_t)row * t->column_count, t->column_count * sizeof *t->fields);
		memmove(t->places[row / 2], t->places[row], sizeof *t->places);
	}
	t->row_count = (t->row_count + 1) / 2;
}

static void keep_row(struct eco_table *t, const struct eco_rows *rows)
{
	char **fields = t->fields + (size_t)t->row_count * t->column_count;
	for (uint32_t i = 0; i < t->column_count; i++)
		fields[i] = eco_copy_text(i < rows->field_count ? rows->fields[i] : "");
	if (t->has_z) {
		char z[32];
		eco_text_of_z(rows, z, sizeof z);
		free(fields[t->column_count - 1]);
		fields[t->column_count - 1] = eco_copy_text(z);
	}
	for (int k = 0; k < 2; k++)
		t->places[t->row_count][k] = rows->place.kind == ECO_PLACE_POINT ? rows->place.at[k] : NAN;
	if (rows->place.width > 0)
		eco_spread_add(&t->crowns, rows->place.width);
	t->row_count++;
}

static void begin(struct eco_table *t, const struct eco_rows *rows)
{
	t->has_geometry = rows->has_geometry;
	t->degrees_doubted = rows->degrees_doubted;
	t->crs = rows->crs ? eco_copy_text(rows->crs) : NULL;
	t->has_z = rows->has_z;
	t->columns = eco_alloc(rows->column_count + 2u, sizeof *t->columns);
	t->fields = eco_alloc((size_t)ECO_TABLE_ROWS * (rows->column_count + 2u), sizeof *t->fields);
	t->places = eco_alloc(ECO_TABLE_ROWS, sizeof *t->places);
	for (; t->column_count < rows->column_count; t->column_count++)
		t->columns[t->column_count] = eco_copy_text(rows->columns[t->column_count]);
	if (t->has_z)
		t->columns[t->column_count++] = eco_copy_text(ECO_COLUMN_GEOMETRY);
}

static enum eco_code read_rows(struct eco_table *t, struct eco_rows *rows, struct eco_error *error)
{
	for (uint64_t stride = 1;; t->rows++) {
		bool more = false;
		enum eco_code code = rows->next(rows, &more, error);
		if (code || !more)
			return code;
		if (t->row_count == ECO_TABLE_ROWS) {
			thin(t);
			stride *= 2;
		}
		if (t->rows % stride == 0)
			keep_row(t, rows);
	}
}

enum eco_code eco_table_read(struct eco_table *table, const struct eco_rows_source *source,
	struct eco_error *error)
{
	struct eco_rows *rows = NULL;
	*table = (struct eco_table){ .path = eco_copy_text(source->path) };
	enum eco_code code = eco_rows_open(&rows, source, error);
	if (!code) {
		begin(table, rows);
		code = read_rows(table, rows, error);
		table->crown_m = table->crowns.seen > 0 ? eco_spread_quantile(&table->crowns, 0.5) : 0;
	}
	if (!code && table->rows == 0)
		code = eco_fail(error, ECO_BAD_INPUT, "%.300s: it has no rows", source->path);
	for (uint32_t i = 0; rows && i < rows->note_count; i++)
		table->notes[table->note_count++] = eco_copy_text(rows->notes[i]);
	eco_rows_close(rows);
	if (code)
		eco_table_free(table);
	return code;
}

void eco_table_free(struct eco_table *table)
{
	for (uint32_t row = 0; row < table->row_count; row++)
		drop_row(table, row);
	for (uint32_t i = 0; i < table->column_count; i++)
		free(table->columns[i]);
	for (uint32_t i = 0; i < table->note_count; i++)
		free(table->notes[i]);
	eco_spread_free(&table->crowns);
	eco_free(table->columns, table->fields, table->places, table->crs, table->path);
	*table = (struct eco_table){ .path = NULL };
}

struct reader {
	struct eco_table_values *values;
	uint32_t capacity;
	struct eco_string_pool texts;
	char trimmed[ECO_WORDS_BYTES];
};

static void add_field(struct reader *r, const char *text, uint64_t line)
{
	struct eco_table_values *v = r->values;
	if (r->texts.count < ECO_TABLE_VALUES_MAX) {
		uint32_t number = eco_string_number(&r->texts, text);
		if (number == v->count) {
			eco_grow(&v->items, &r->capacity, v->count, sizeof *v->items);
			v->items[v->count++] = (struct eco_table_value){ .text = eco_copy_text(text),
				.first_line = line };
		}
		v->items[number].rows++;
	}
}

ECO_ORDER_FALLING_TWO(compare, struct eco_table_value, ->rows, ->first_line)

static enum eco_code read_values(struct reader *r, struct eco_rows *rows, const uint32_t *columns, uint32_t count,
	struct eco_error *error)
{
	for (;;) {
		char text[ECO_WORDS_BYTES] = "";
		bool more = false;
		enum eco_code code = rows->next(rows, &more, error);
		if (code || !more)
			return code;
		for (uint32_t i = 0; i < count && columns[i] < rows->field_count; i++)
			eco_text_join(text, sizeof text, eco_text_trim(rows->fields[columns[i]], r->trimmed,
				sizeof r->trimmed));
		if (columns[0] < rows->field_count)
			add_field(r, text, rows->line);
	}
}

enum eco_code eco_table_values_read(struct eco_table_values *values, const struct eco_rows_source *source,
	const char *const *columns, uint32_t count, struct eco_error *error)
{
	struct eco_rows_source wanted = *source;
	struct eco_rows *rows = NULL;
	uint32_t at[ECO_COLUMNS_JOINED] = { 0 };
	*values = (struct eco_table_values){ .items = NULL };
	wanted.wanted = columns;
	wanted.wanted_count = count;
	enum eco_code code = eco_rows_open(&rows, &wanted, error);
	struct reader r = { .values = values };
	for (uint32_t i = 0; i < count && !code; i++)
		code = eco_rows_find_column(rows, source->path, columns[i], &at[i], error);
	if (!code)
		code = read_values(&r, rows, at, count, error);
	eco_rows_close(rows);
	eco_string_pool_free(&r.texts);
	if (code)
		eco_table_values_free(values);
	else
		qsort(values->items, values->count, sizeof *values->items, compare);
	return code;
}

void eco_table_values_free(struct eco_table_values *values)
{
	for (uint32_t i = 0; i < values->count; i++)
		free(values->items[i].text);
	free(values->items);
	*values = (struct eco_table_values){ .items = NULL };
}
