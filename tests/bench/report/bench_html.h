/* Pieces of the pages that ecobench writes: report.html and papers.html. */
#ifndef TESTS_BENCH_HTML_H
#define TESTS_BENCH_HTML_H

#include <jansson.h>
#include <stdio.h>

/* For a <style>. */
extern const char bench_html_style[];
/* NULL is nothing. */
void bench_html_text(FILE *out, const char *text);
/* An item of a section's record (bench_state.h): a table, a picture, a paragraph or a heading. */
void bench_html_item(FILE *out, const json_t *item);

#endif
