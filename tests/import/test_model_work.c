/* The work of an import grows with the model, however many pieces, materials, parts or nodes it has. Work is
 * the number of basic blocks that the room runs: the Makefile compiles it for this test so that each block
 * calls __sanitizer_cov_trace_pc. */
#include <sys/mman.h>

#include "tests/support/model_try.h"

#define FEW 1500u
#define TIMES 8u
/* Work at TIMES as many, over TIMES the work at FEW: 1 is linear. Quadratic work would be TIMES. */
#define MOST 1.5

/* Import runs in a child process: the page is shared with it. */
static uint64_t unshared, *work = &unshared;

void __sanitizer_cov_trace_pc(void);
void __sanitizer_cov_trace_pc(void)
{
	++*work;
}

/* ---- Models of `count` pieces ---- */

/* Triangle i, away from all others. */
static void put_triangle(FILE *to, unsigned i)
{
	double x = i % 97 * 0.05, y = i % 89 * 0.05, z = i % 83 * 0.05 + i * 1e-5;
	fprintf(to, "v %.6f %.6f %.6f\nv %.6f %.6f %.6f\nv %.6f %.6f %.6f\nf -3 -2 -1\n", x, y, z, x + .02, y,
		z + .01, x, y + .02, z + .02);
}

static void put_piece(FILE *to, unsigned i, unsigned count) { put_triangle(to, i); }

/* Level squares, each as large as the next: a sheet that all else stands on is looked for among them. */
static void put_sheet(FILE *to, unsigned i, unsigned count)
{
	fprintf(to, "v %u 0 0\nv %u 0 1\nv %u 0 1\nv %u 0 0\nf -4 -3 -2 -1\n", 2 * i, 2 * i, 2 * i + 1, 2 * i + 1);
}

/* Its triangles from the last on. */
static void put_strip(FILE *to, unsigned i, unsigned count)
{
	for (unsigned v = 0; v < count + 2 && i == 0; v++)
		fprintf(to, "v %u %u %u\n", v % 2, v, v / 2 % 2);
	fprintf(to, "f %u %u %u\n", count - i, count - i + 1, count - i + 2);
}

/* A triangle each of a material or a part. */
static void put_material(FILE *to, unsigned i, unsigned count)
{
	fprintf(to, "usemtl m%u\n", i);
	put_triangle(to, i);
}

static void put_object(FILE *to, unsigned i, unsigned count)
{
	fprintf(to, "o leaf_LOD%u\n", i);
	put_triangle(to, i);
}

/* Names that are there, that differ in case, and that are not there. */
static void put_library(FILE *to, unsigned i, unsigned count)
{
	fprintf(to, "newmtl %c%u\nKd %g 1 0\n", "mMn"[i % 3], i, i % 256 / 255.0);
}

/* (0, 0, 0), (0.1, 0, 0), (0, 0.1, 0) in floats */
#define TRIANGLE "AAAAAAAAAAAAAAAAzczMPQAAAAAAAAAAAAAAAM3MzD0AAAAA"

/* Nodes share a mesh. */
#define NODES_HEAD "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"data:;base64," TRIANGLE \
	"\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0," \
	"\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{" \
	"\"POSITION\":0},\"targets\":[{\"POSITION\":0}]}]}],\"nodes\":["

/* Each with a morph weight of its own. */
static void put_weight(FILE *to, unsigned i, unsigned count)
{
	fprintf(to, "%s{\"mesh\":0,\"translation\":[%g,%g,0.001],\"weights\":[%.6f]}", i ? "," : "", i % 97 * 0.1,
		i % 89 * 0.1, i * 1e-5);
}

/* Each in the one before. */
static void put_link(FILE *to, unsigned i, unsigned count)
{
	fprintf(to, "%s{\"mesh\":0,\"translation\":[0.001,0.002,0.001]", i ? "," : "");
	fprintf(to, i + 1 < count ? ",\"children\":[%u]}" : "}", i + 1);
}

static const struct kind {
	const char *name, *file, *head, *tail;
	void (*put)(FILE *to, unsigned i, unsigned count);
} kinds[] = {
	{ "pieces", "pieces.obj", "", "", put_piece },
	{ "sheets", "sheets.obj", "", "v 0 0 0\nv 1 0 0\nv 0 9 0\nf -3 -2 -1\n", put_sheet },
	{ "strip", "strip.obj", "", "", put_strip },
	{ "materials", "materials.obj", "", "", put_material },
	{ "materials of a library", "library.obj", "mtllib library.mtl\n", "", put_material },
	{ "objects", "objects.obj", "", "", put_object },
	{ "nodes with weights", "weights.gltf", NODES_HEAD, "]}", put_weight },
	{ "a chain of nodes", "chain.gltf", NODES_HEAD, "]}", put_link },
};

static const char *write_kind(const struct kind *kind, unsigned count)
{
	const char *path = input_path("model_work", kind->file);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fprintf(file, "%s", kind->head);
	for (unsigned i = 0; i < count; i++)
		kind->put(file, i, count);
	fprintf(file, "%s", kind->tail);
	fclose(file);
	return path;
}

/* ---- What they cost ---- */

static uint64_t work_of(const struct kind *kind, unsigned count)
{
	static const struct kind library = { "a library", "library.mtl", "", "", put_library };
	write_kind(&library, count);
	*work = 0;
	import_file(write_kind(kind, count), NULL);
	return *work;
}

UNIT_TEST(work_grows_with_the_model_and_not_faster)
{
	work = mmap(NULL, sizeof *work, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	assert_true(work != MAP_FAILED);
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		uint64_t few = work_of(&kinds[i], FEW), many = work_of(&kinds[i], FEW * TIMES);
		double growth = (double)many / (TIMES * (double)few);
		printf("# %s: %llu blocks for %u, %llu for %u: %.2f of linear\n", kinds[i].name,
			(unsigned long long)few, FEW, (unsigned long long)many, FEW * TIMES, growth);
		assert_true(few > 20 * FEW);
		if (growth > MOST)
			fail_msg("%s: %.2f times the work of a linear import", kinds[i].name, growth);
	}
}
