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

static FILE *create(const char *name, const char **path)
{
	*path = input_path("model_work", name);
	FILE *file = fopen(*path, "w");
	assert_non_null(file);
	return file;
}

/* Triangle i, away from all others. */
static void put_triangle(FILE *to, unsigned i)
{
	double x = i % 97 * 0.05, y = i % 89 * 0.05, z = i % 83 * 0.05 + i * 1e-5;
	fprintf(to, "v %.6f %.6f %.6f\nv %.6f %.6f %.6f\nv %.6f %.6f %.6f\nf -3 -2 -1\n", x, y, z, x + .02, y,
		z + .01, x, y + .02, z + .02);
}

static const char *write_pieces(unsigned count)
{
	const char *path;
	FILE *file = create("pieces.obj", &path);
	for (unsigned i = 0; i < count; i++)
		put_triangle(file, i);
	fclose(file);
	return path;
}

/* Level squares, each as large as the next: a sheet that all else stands on is looked for among them. */
static const char *write_sheets(unsigned count)
{
	const char *path;
	FILE *file = create("sheets.obj", &path);
	for (unsigned i = 0; i < count; i++)
		fprintf(file, "v %u 0 0\nv %u 0 1\nv %u 0 1\nv %u 0 0\nf -4 -3 -2 -1\n", 2 * i, 2 * i,
			2 * i + 1, 2 * i + 1);
	fprintf(file, "v 0 0 0\nv 1 0 0\nv 0 9 0\nf -3 -2 -1\n");
	fclose(file);
	return path;
}

static const char *write_strip(unsigned count)
{
	const char *path;
	FILE *file = create("strip.obj", &path);
	for (unsigned i = 0; i < count + 2; i++)
		fprintf(file, "v %u %u %u\n", i % 2, i, i / 2 % 2);
	for (unsigned i = count; i > 0; i--)
		fprintf(file, "f %u %u %u\n", i, i + 1, i + 2);
	fclose(file);
	return path;
}

/* A triangle each of a material or a part. */
static const char *write_named(unsigned count, const char *name, const char *head, const char *statement)
{
	const char *path;
	FILE *file = create(name, &path);
	fprintf(file, "%s", head);
	for (unsigned i = 0; i < count; i++) {
		fprintf(file, "%s%u\n", statement, i);
		put_triangle(file, i);
	}
	fclose(file);
	return path;
}

static const char *write_materials(unsigned count)
{
	return write_named(count, "materials.obj", "", "usemtl m");
}

/* Names that are there, that differ in case, and that are not there. */
static const char *write_library(unsigned count)
{
	const char *path;
	FILE *file = create("library.mtl", &path);
	for (unsigned i = 0; i < count; i++)
		fprintf(file, "newmtl %c%u\nKd %g 1 0\n", "mMn"[i % 3], i, i % 256 / 255.0);
	fclose(file);
	return write_named(count, "library.obj", "mtllib library.mtl\n", "usemtl m");
}

static const char *write_objects(unsigned count)
{
	return write_named(count, "objects.obj", "", "o leaf_LOD");
}

/* (0, 0, 0), (0.1, 0, 0), (0, 0.1, 0) in floats */
#define TRIANGLE "AAAAAAAAAAAAAAAAzczMPQAAAAAAAAAAAAAAAM3MzD0AAAAA"

/* Nodes that share a mesh, each with a morph weight of its own if `weights`; each in the one before if
 * `chain`. */
static const char *write_nodes(unsigned count, const char *name, bool weights, bool chain)
{
	const char *path;
	FILE *file = create(name, &path);
	fprintf(file, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,"
		"\"uri\":\"data:;base64,%s\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
		"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
		"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
		"\"targets\":[{\"POSITION\":0}]}]}],\"scene\":0,\"scenes\":[{\"nodes\":[0",
		TRIANGLE);
	for (unsigned i = 1; i < count && !chain; i++)
		fprintf(file, ",%u", i);
	fprintf(file, "]}],\"nodes\":[");
	for (unsigned i = 0; i < count; i++) {
		fprintf(file, "%s{\"mesh\":0,\"translation\":[%g,%g,0.001]", i ? "," : "", chain ? 0.001
			: i % 97 * 0.1, chain ? 0.002 : i % 89 * 0.1);
		if (weights)
			fprintf(file, ",\"weights\":[%.6f]", i * 1e-5);
		if (chain && i + 1 < count)
			fprintf(file, ",\"children\":[%u]", i + 1);
		fprintf(file, "}");
	}
	fprintf(file, "]}");
	fclose(file);
	return path;
}

static const char *write_weights(unsigned count) { return write_nodes(count, "weights.gltf", true, false); }
static const char *write_chain(unsigned count) { return write_nodes(count, "chain.gltf", false, true); }

/* ---- What they cost ---- */

static uint64_t work_of(const char *path)
{
	*work = 0;
	import_file(path, NULL);
	return *work;
}

UNIT_TEST(work_grows_with_the_model_and_not_faster)
{
	static const struct { const char *name; const char *(*write)(unsigned count); } kinds[] = {
		{ "pieces", write_pieces }, { "sheets", write_sheets }, { "strip", write_strip },
		{ "materials", write_materials }, { "materials of a library", write_library },
		{ "objects", write_objects }, { "nodes with weights", write_weights },
		{ "a chain of nodes", write_chain } };

	work = mmap(NULL, sizeof *work, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	assert_true(work != MAP_FAILED);
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		uint64_t few = work_of(kinds[i].write(FEW)), many = work_of(kinds[i].write(FEW * TIMES));
		double growth = (double)many / (TIMES * (double)few);
		printf("# %s: %llu blocks for %u, %llu for %u: %.2f of linear\n", kinds[i].name,
			(unsigned long long)few, FEW, (unsigned long long)many, FEW * TIMES, growth);
		assert_true(few > 20 * FEW);
		if (growth > MOST)
			fail_msg("%s: %.2f times the work of a linear import", kinds[i].name, growth);
	}
}
