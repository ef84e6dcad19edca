/* Flipped bits and cut ends of a pack and of a stream: each must be noticed.
 *
 *   damages PACK COUNT [SEED]
 *
 * Prints how many were not; exit 1 if there was one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "tests/support/files.h"
#include "tests/support/serve/random_request.h"

/* Parses without decoding: every frame's hash, fields and order. True if the whole was accepted. */
static bool stream_accepted(const uint8_t *bytes, size_t size)
{
	static const struct eco_wire_events nothing;
	struct eco_wire_parser *parser;
	struct eco_error error = { 0 };
	if (eco_wire_parser_new(&parser, &nothing, NULL, &error))
		random_stop("parser", &error);
	bool ok = !eco_wire_feed(parser, bytes, size, &error) && !eco_wire_finish(parser, &error);
	eco_wire_parser_free(parser);
	return ok;
}

static uint8_t *flatten(const struct srv_body *body)
{
	uint8_t *all = malloc(body->size_bytes + 1), *at = all;
	for (uint32_t i = 0; i < body->piece_count; at += body->pieces[i++].size)
		memcpy(at, body->pieces[i].bytes, body->pieces[i].size);
	return all;
}

/* A stream of 2,000 vertices. */
static void some_stream(const struct srv_scene *scene, uint64_t seed, struct srv_body *body)
{
	struct eco_request request;
	for (uint64_t i = 0;; i++) {
		bool usable = random_request(&request, &scene->pack->scene, seed, i);
		request.vertices = 2000;
		request.bytes = ECO_BYTES_UNBOUNDED;
		if (usable && random_answer(scene, &request, NULL, 0, body))
			return;
	}
}

static uint64_t damage_stream(const struct srv_scene *scene, long damages, uint64_t seed)
{
	struct dice r = { seed };
	struct srv_body body;
	uint64_t unnoticed = 0;
	some_stream(scene, seed, &body);
	uint8_t *bytes = flatten(&body);
	if (!stream_accepted(bytes, body.size_bytes))
		random_stop("stream", &(struct eco_error){ .text = "the undamaged stream is refused" });
	for (long i = 0; i < damages; i++) {
		uint64_t at = dice_bits(&r) % body.size_bytes;
		uint8_t flip = (uint8_t)(1u << (dice_bits(&r) % 8));
		if (i % 4 == 3) {
			unnoticed += stream_accepted(bytes, at);
			continue;
		}
		bytes[at] ^= flip;
		unnoticed += stream_accepted(bytes, body.size_bytes);
		bytes[at] ^= flip;
	}
	free(bytes);
	srv_body_free(&body);
	return unnoticed;
}

/* A pack is noticed to be damaged when it is opened or, inside a chunk, when that chunk is read. */
static bool pack_accepted(const uint8_t *bytes, size_t size, uint64_t at)
{
	struct eco_pack *pack;
	struct eco_error error = { 0 };
	bool ok = true;
	if (eco_pack_open_memory(&pack, bytes, size, &error))
		return false;
	for (uint32_t i = 0; i < pack->scene.chunk_count && ok; i++) {
		const struct eco_chunk *chunk = &pack->scene.chunks[i];
		const uint8_t *payload;
		size_t payload_bytes;
		/* only what the damage can have touched: reading every chunk 10^5 times would take hours */
		if (at >= chunk->offset && at < chunk->offset + chunk->size_bytes)
			ok = !eco_pack_payload(pack, i, &payload, &payload_bytes, &error);
	}
	eco_pack_close(pack);
	return ok;
}

static uint64_t damage_pack(const char *path, long damages, uint64_t seed)
{
	struct dice r = { seed };
	uint64_t unnoticed = 0;
	size_t size;
	uint8_t *bytes = file_read(path, &size);
	if (!pack_accepted(bytes, size, 0))
		random_stop(path, &(struct eco_error){ .text = "the undamaged pack is refused" });
	for (long i = 0; i < damages; i++) {
		/* half of them in the tables, which are small beside the chunks */
		uint64_t at = dice_bits(&r) % (i % 2 && size > 65536 ? 65536 : size);
		if (i % 8 == 7) {
			unnoticed += pack_accepted(bytes, at, at);
			continue;
		}
		uint8_t flip = (uint8_t)(1u << (dice_bits(&r) % 8));
		bytes[at] ^= flip;
		unnoticed += pack_accepted(bytes, size, at);
		bytes[at] ^= flip;
	}
	free(bytes);
	return unnoticed;
}

int main(int argc, char **argv)
{
	struct srv_store scenes;
	struct eco_error error = { 0 };
	if (argc < 3 || argc > 4) {
		fprintf(stderr, "usage: damages PACK COUNT [SEED]\n");
		return 2;
	}
	long damages = atol(argv[2]);
	uint64_t seed = argc == 4 ? strtoull(argv[3], NULL, 10) : 1;
	srv_store_init(&scenes);
	if (srv_store_add(&scenes, "scene", argv[1], &error))
		random_stop(argv[1], &error);
	uint64_t stream = damage_stream(scenes.scenes[0], damages, seed),
		file = damage_pack(argv[1], damages, seed);
	printf("%ld damages of a stream: %llu unnoticed; %ld of the pack: %llu unnoticed\n", damages,
		(unsigned long long)stream, damages, (unsigned long long)file);
	srv_store_free(&scenes);
	return stream || file;
}
