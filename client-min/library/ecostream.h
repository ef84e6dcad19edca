/* libecostream: both ends of ecostream in other programs, without HTTP. One end opens a pack, plans what a
 * view needs within a budget and encodes it as a stream; the other decodes streams, keeps what they brought,
 * and says what is drawn where.
 *
 *   struct ecostream_error error = { 0 };
 *   struct ecostream_pack *pack;
 *   struct ecostream_answer *answer;
 *   struct ecostream_request request = { .eye = { 0, -30, 5 }, .target = { 0, 0, 4 }, .up = { 0, 0, 1 },
 *           .fov_y_deg = 45, .width = 800, .height = 600, .vertices = 300000 };
 *   if (ecostream_pack_open(&pack, "my.eco", &error)                    // where packs are
 *                   || ecostream_plan(&answer, pack, &request, &error)
 *                   || ecostream_encode(answer, send, socket, &error))
 *           puts(error.text);
 *   ecostream_answer_free(answer);
 *   ecostream_pack_close(pack);
 *
 *   ecostream_client_new(&client, &error);                              // where pictures are
 *   ecostream_client_holdings(client, &bytes, &size, &error);           // travels with the request
 *   ecostream_client_begin(client, &error);
 *   ecostream_client_feed(client, bytes, size, &error);                 // as they come, in any portions
 *   ecostream_client_end(client, &error);
 *   ecostream_picture_make(&picture, client, &request, &error);         // what is drawn, and where
 *
 * Coordinates are metres from the scene's origin, right-handed, Z up; angles are degrees.
 *
 * Errors. Functions that can fail return a code, 0 where all went well, and take an error that may be NULL.
 * Its first failure stays: begin with a zero. A function that fails leaves its result NULL or as it was, and
 * whatever it was given as it was, but for a client (below). Nothing that comes from outside, packs, streams
 * or requests, is trusted.
 * Objects. The caller that makes one frees it; freeing NULL does nothing. A function's loan lives as long as
 * it says.
 * Threads. Packs are immutable: any number of threads may plan with one. All else: one thread at a time.
 * ABI. The soname's number changes whenever a program would have to be compiled anew; structs do not grow
 * within one. */
#ifndef ECOSTREAM_H
#define ECOSTREAM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum ecostream_code {
	ECOSTREAM_OK = 0,
	ECOSTREAM_BAD_USAGE,         /* a call that makes no sense, such as feeding before beginning */
	ECOSTREAM_BAD_INPUT,         /* a file or request that says something impossible */
	ECOSTREAM_DAMAGED,           /* a hash, count or bound of a pack or stream does not hold */
	ECOSTREAM_TOO_LARGE,         /* beyond a limit, which the text states */
	ECOSTREAM_UNSUPPORTED,
	ECOSTREAM_NOT_FOUND,
	ECOSTREAM_IO,                /* the operating system refused, or a write callback did */
	ECOSTREAM_NO_MEMORY,
	ECOSTREAM_INTERRUPTED
};

/* The text says what was wrong, where, and what to do: UTF-8, one line. */
struct ecostream_error { enum ecostream_code code; char text[512]; };

/* The library's version, such as "0.2"; static. */
const char *ecostream_version(void);

/* ---- Packs ---- */

struct ecostream_pack;

/* Maps the pack and checks all but the payloads of its chunks, whose hashes are checked when they are first
 * needed. The file must not change while it is open: replace it by renaming another over it. */
enum ecostream_code ecostream_pack_open(struct ecostream_pack **pack, const char *path,
	struct ecostream_error *error);
void ecostream_pack_close(struct ecostream_pack *pack);

struct ecostream_pack_info {
	const char *name;            /* of the scene, UTF-8; lives as long as the pack */
	uint64_t plants;             /* that stand in it */
	uint32_t kinds, lists;
	double low[3], high[3];      /* bounds of its plants */
};
void ecostream_pack_info(const struct ecostream_pack *pack, struct ecostream_pack_info *info);

/* ---- Planning ---- */

struct ecostream_request {
	double eye[3], target[3], up[3];
	double fov_y_deg;            /* of the picture's height, in (0, 180) */
	uint32_t width, height;      /* of the picture, 1 to 16384 pixels */
	uint64_t vertices;           /* budget: points + 2 lines + 3 triangles drawn, at each place */
	uint64_t bytes;              /* budget of the whole stream; 0: none */
	const void *holdings;        /* what the client has (ecostream_client_holdings); NULL: nothing */
	size_t holdings_size;
};

/* The answer to a request: a plan, and the chunks that the client lacks. It lends from the pack, which must
 * outlive it. */
struct ecostream_answer;

/* Plans; copies no payload. ECOSTREAM_BAD_INPUT names what of the request is impossible, or says that the
 * holdings are not of this pack. The same request gives the same answer, byte for byte. */
enum ecostream_code ecostream_plan(struct ecostream_answer **answer, const struct ecostream_pack *pack,
	const struct ecostream_request *request, struct ecostream_error *error);
void ecostream_answer_free(struct ecostream_answer *answer);

struct ecostream_counts {
	uint64_t bytes;              /* of the stream; 0: not even the smallest one fits the budget */
	uint64_t vertices;           /* that are drawn; never above the request's */
	uint64_t plants;             /* in view */
	uint64_t chunks;             /* in the stream */
	uint32_t cuts;               /* ranges of lists that are drawn */
	double expected_q;           /* 1 less the picture's distance from Precision and Recall of 1 */
	double expected_m16;         /* mean CIELAB distance, to full detail, of mean colors of 16 x 16 pixels */
};
void ecostream_answer_counts(const struct ecostream_answer *answer, struct ecostream_counts *counts);

/* Takes the next bytes of a stream, which live during the call. Anything but 0 ends encoding with
 * ECOSTREAM_IO. */
typedef int ecostream_write(void *context, const void *bytes, size_t size);
/* Writes counts.bytes bytes, in order. Any beginning that ends after a plan is a valid, coarser picture. */
enum ecostream_code ecostream_encode(const struct ecostream_answer *answer, ecostream_write *write,
	void *context, struct ecostream_error *error);

/* ---- Decoding ---- */

/* Data of one scene, over any number of streams: at most 8 GiB, decoded. */
struct ecostream_client;

enum ecostream_code ecostream_client_new(struct ecostream_client **client, struct ecostream_error *error);
void ecostream_client_free(struct ecostream_client *client);

/* Holdings for the next request. *bytes is the caller's: free() it. */
enum ecostream_code ecostream_client_holdings(const struct ecostream_client *client, void **bytes,
	size_t *size, struct ecostream_error *error);

/* A stream begins: its plan will replace the one before it. */
enum ecostream_code ecostream_client_begin(struct ecostream_client *client, struct ecostream_error *error);
/* Decodes bytes as they come. After an error the stream is over; what came before it is kept and may be
 * drawn. */
enum ecostream_code ecostream_client_feed(struct ecostream_client *client, const void *bytes, size_t size,
	struct ecostream_error *error);
/* ECOSTREAM_DAMAGED if the stream is not whole. A stream that is stopped half way needs no end. */
enum ecostream_code ecostream_client_end(struct ecostream_client *client, struct ecostream_error *error);

/* ---- Drawing ---- */

/* The picture of the last plan, for the view that it was asked for. It lends from the client: free it before
 * the next stream begins. */
struct ecostream_picture;

/* Only the view of `request` counts. ECOSTREAM_NOT_FOUND: no plan has come. ECOSTREAM_DAMAGED: it draws
 * another number of vertices than the stream said, as for another view. */
enum ecostream_code ecostream_picture_make(struct ecostream_picture **picture,
	const struct ecostream_client *client, const struct ecostream_request *request,
	struct ecostream_error *error);
void ecostream_picture_free(struct ecostream_picture *picture);

enum ecostream_kind {
	ECOSTREAM_POINTS,            /* a ball each */
	ECOSTREAM_LINES,             /* a cylinder each */
	ECOSTREAM_TRIANGLES,         /* seen from both sides */
	ECOSTREAM_ELLIPSOIDS,
	ECOSTREAM_IMPOSTORS,         /* a whole plant in one vertex: ecostream_picture_look */
	ECOSTREAM_GROUND             /* triangles; no vertices of the budget */
};

/* world = at + scale * turned(p), turned counter-clockwise about Z */
struct ecostream_place { double at[3], sine, cosine, scale; };

/* One range of a list, and the places where it is drawn. */
struct ecostream_draw {
	enum ecostream_kind kind;
	uint32_t primitives;         /* at each place */
	uint32_t places;
	uint64_t vertices;           /* of the budget, at all places */
	char plant[64];              /* its name; "" of ground, and of points for many plants */
};
uint32_t ecostream_picture_draws(const struct ecostream_picture *picture);
/* `draw` is below ecostream_picture_draws. */
void ecostream_picture_draw(const struct ecostream_picture *picture, uint32_t draw,
	struct ecostream_draw *info);
/* Writes the places of a draw: info.places of them. */
void ecostream_picture_places(const struct ecostream_picture *picture, uint32_t draw,
	struct ecostream_place *places);

/* Primitives of a draw, before they are placed; arrays are lent, and live until ecostream_geometry_free. */
struct ecostream_geometry {
	uint32_t primitives;
	/* metres: 6 of a line, 9 of a triangle,
		else the centre: of impostors that of a ball around the plant */
	const float *position;
	const float *size;           /* radius of a point, of that ball; width of a line; else NULL */
	const float *half_axes;      /* of ellipsoids: three vectors, 9 of each; else NULL */
	const float *opacity;        /* of ellipsoids, and of points that are not opaque, in (0, 1]; else NULL */
	const uint8_t *rgb;          /* sRGB, 3 of each; NULL of ground and impostors. White where only a
	                              * texture has colours: this version does not hand out textures */
	void *owned;                 /* the library's */
};
enum ecostream_code ecostream_picture_geometry(const struct ecostream_picture *picture, uint32_t draw,
	struct ecostream_geometry *geometry, struct ecostream_error *error);
void ecostream_geometry_free(struct ecostream_geometry *geometry);

/* Looks at the plant that a draw of ECOSTREAM_IMPOSTORS shows, along `count` rays (3 of each) from an eye;
 * both as seen from the plant, before it is placed. along[i]: how many times ray i leads to it, or INFINITY
 * where it passes; rgb, 3 of each, is the sRGB colour there, else left as it was. */
void ecostream_picture_look(const struct ecostream_picture *picture, uint32_t draw, const float eye[3],
	const float *rays, uint32_t count, float *along, uint8_t *rgb);

#ifdef __cplusplus
}
#endif

#endif
