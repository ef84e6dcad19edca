/* convert IN OUT: a model in another format, by OUT's extension, through assimp. Tests get one plant in all
 * formats by it; its input is trusted. */
#include <stdio.h>
#include <string.h>

#include <assimp/cexport.h>
#include <assimp/cimport.h>
#include <assimp/postprocess.h>

/* ids of assimp that are not extensions: binary PLY; FBX as text, as its binary FBX cannot be read again */
static const struct { const char *extension, *id; } formats[] = { { "glb", "glb2" }, { "gltf", "gltf2" },
	{ "dae", "collada" },
	{ "ply", "plyb" }, { "stl", "stlb" }, { "fbx", "fbxa" } };

int main(int argc, char **argv)
{
	const char *extension = argc == 3 ? strrchr(argv[2], '.') : NULL;
	if (!extension) {
		fprintf(stderr, "usage: convert IN OUT.{obj,ply,dae,fbx,glb,stl,3ds}\n");
		return 2;
	}
	const char *id = ++extension;
	for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
		if (strcmp(formats[i].extension, extension) == 0)
			id = formats[i].id;
	const struct aiScene *scene = aiImportFile(argv[1], aiProcess_Triangulate);
	if (!scene || aiExportScene(scene, id, argv[2], 0) != aiReturn_SUCCESS) {
		fprintf(stderr, "convert: %s to %s: %s\n", argv[1], argv[2], aiGetErrorString());
		return 1;
	}
	aiReleaseImport(scene);
	return 0;
}
