/* A program of somebody else, as small as it gets: library_user PACK. */
#include <ecostream.h>
#include <stdio.h>

int main(int argc, char **argv)
{
	struct ecostream_request view = { { 12, -30, 8 }, { 0, 0, 4 }, { 0, 0, 1 }, 45, 800, 600,
		.vertices = 300000 };
	struct ecostream_error error = { 0 };
	struct ecostream_pack *pack = NULL;
	struct ecostream_answer *answer = NULL;
	struct ecostream_counts counts;
	if (ecostream_pack_open(&pack, argc > 1 ? argv[1] : "", &error) || ecostream_plan(&answer, pack,
		&view, &error))
		return fprintf(stderr, "%s\n", error.text), 1;
	ecostream_answer_counts(answer, &counts);
	printf("%llu vertices, %llu plants, %u cuts, %llu bytes\n", (unsigned long long)counts.vertices,
		(unsigned long long)counts.plants, counts.cuts, (unsigned long long)counts.bytes);
	ecostream_answer_free(answer);
	ecostream_pack_close(pack);
	return 0;
}
