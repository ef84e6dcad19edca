/* Codes of splats: see splat.h. */
#include "ecofiles/format/splat.h"

#include <math.h>

#define LENGTH_ONE 64            /* code of a half axis as long as the unit */
#define TURN_NONE 16

static int32_t clamp(int32_t code, uint32_t count)
{
	return code < 0 ? 0 : code >= (int32_t)count ? (int32_t)count - 1 : code;
}

/* 2^((code - LENGTH_ONE) / 8) */
static float length_of(int32_t code)
{
	static const float eighth[8] = { 1, 1.090507733f, 1.189207115f, 1.296839555f, 1.414213562f,
		1.542210825f, 1.681792831f, 1.834008086f };
	return ldexpf(eighth[code % 8], code / 8 - LENGTH_ONE / 8);
}

/* The code whose length is nearest by ratio. */
static int32_t length_code(float length)
{
	static const float half_step = 1.044273782f;
	int32_t low = 0, high = ECO_SPLAT_LENGTHS - 1;
	while (low < high) {
		int32_t middle = (low + high) / 2;
		if (length_of(middle) * half_step < length)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

bool eco_splat_good(const int32_t code[ECO_SPLAT_CODES])
{
	static const uint32_t count[3] = { ECO_SPLAT_LENGTHS, ECO_SPLAT_TURNS,
		ECO_SPLAT_OPACITIES * ECO_SPLAT_KINDS };
	for (uint32_t i = 0; i < ECO_SPLAT_CODES; i++)
		if (code[i] < 0 || (uint32_t)code[i] >= count[i / 3])
			return false;
	return true;
}

void eco_splat_read(struct eco_splat *splat, const int32_t code[ECO_SPLAT_CODES], float unit)
{
	float v[3], square = 0;
	for (int k = 0; k < 3; k++) {
		v[k] = (float)(clamp(code[3 + k], ECO_SPLAT_TURNS) - TURN_NONE) / ECO_SPLAT_TURN;
		square += v[k] * v[k];
	}
	float w = square < 1 ? sqrtf(1 - square) : 0, x = v[0], y = v[1], z = v[2];
	const float axis[3][3] = {
		{ 1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y) },
		{ 2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x) },
		{ 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y) },
	};
	for (int k = 0; k < 3; k++) {
		float length = unit * length_of(clamp(code[k], ECO_SPLAT_LENGTHS));
		for (int i = 0; i < 3; i++)
			splat->half[k][i] = length * axis[k][i];
	}
	int32_t look = clamp(code[6], ECO_SPLAT_OPACITIES * ECO_SPLAT_KINDS);
	splat->wood = look >= (int32_t)ECO_SPLAT_OPACITIES;
	splat->opacity = (float)(look % (int32_t)ECO_SPLAT_OPACITIES + 1) / ECO_SPLAT_OPACITIES;
}

/* Axes in the order `order`, each reversed where that turns it towards its coordinate axis; an odd number of
 * reversals and swaps is mended by the axis to which that matters least. Returns the trace. */
static float arrange(const float unit[3][3], const int order[3], bool odd, float turned[3][3])
{
	float trace = 0;
	int least = 0;
	for (int k = 0; k < 3; k++) {
		float sign = unit[order[k]][k] < 0 ? -1 : 1;
		odd ^= sign < 0;
		for (int i = 0; i < 3; i++)
			turned[k][i] = sign * unit[order[k]][i];
		trace += turned[k][k];
		least = turned[k][k] < turned[least][least] ? k : least;
	}
	for (int i = 0; i < 3 && odd; i++)
		turned[least][i] = -turned[least][i];
	return odd ? trace + 2 * turned[least][least] : trace;
}

/* Unit axes of a right-handed frame; those of an axis without length are made up. */
static void frame_of(const struct eco_splat *splat, float length[3], float unit[3][3])
{
	int longest = 0, shortest = 0;
	for (int k = 0; k < 3; k++) {
		const float *h = splat->half[k];
		length[k] = sqrtf(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
		longest = length[k] > length[longest] ? k : longest;
		shortest = length[k] <= length[shortest] ? k : shortest;
	}
	int other = 3 - longest - shortest;
	if (longest == shortest || !(length[longest] > 0)) {
		longest = 0, other = 1, shortest = 2;
	}
	float *a = unit[longest], *b = unit[other], *c = unit[shortest], along = 0, size = 0;
	for (int i = 0; i < 3; i++)
		a[i] = length[longest] > 0 ? splat->half[longest][i] / length[longest] : i == longest;
	for (int i = 0; i < 3; i++)
		along += a[i] * splat->half[other][i];
	for (int i = 0; i < 3; i++) {
		b[i] = splat->half[other][i] - along * a[i];
		size += b[i] * b[i];
	}
	if (!(sqrtf(size) > 1e-6f * length[longest])) {
		int flat = fabsf(a[0]) < fabsf(a[1]) ? 0 : 1;
		flat = fabsf(a[2]) < fabsf(a[flat]) ? 2 : flat;
		size = 1 - a[flat] * a[flat];
		for (int i = 0; i < 3; i++)
			b[i] = (i == flat) - a[flat] * a[i];
	}
	for (int i = 0; i < 3; i++)
		b[i] /= sqrtf(size);
	for (int i = 0; i < 3; i++)
		c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
	bool even = (other - longest + 3) % 3 == 1;
	for (int i = 0; i < 3 && !even; i++)
		c[i] = -c[i];
}

void eco_splat_write(int32_t code[ECO_SPLAT_CODES], const struct eco_splat *splat, float unit)
{
	static const int orders[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 1, 0, 2 }, { 0, 2, 1 },
		{ 2, 1, 0 } };
	float length[3], axes[3][3], turned[3][3], best = -2;
	int chosen = 0;
	frame_of(splat, length, axes);
	for (int o = 0; o < 6; o++) {
		float trace = arrange(axes, orders[o], o >= 3, turned);
		if (trace > best) {
			best = trace;
			chosen = o;
		}
	}
	best = arrange(axes, orders[chosen], chosen >= 3, turned);
	float w = 0.5f * sqrtf(1 + best > 0 ? 1 + best : 0);
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		float v = (turned[i][j] - turned[j][i]) / (4 * w);
		code[k] = length_code(unit > 0 ? length[orders[chosen][k]] / unit : 0);
		code[3 + k] = clamp((int32_t)floorf(v * ECO_SPLAT_TURN + 0.5f) + TURN_NONE, ECO_SPLAT_TURNS);
	}
	code[6] = clamp((int32_t)floorf(splat->opacity * ECO_SPLAT_OPACITIES + 0.5f) - 1,
		ECO_SPLAT_OPACITIES) + (splat->wood ? (int32_t)ECO_SPLAT_OPACITIES : 0);
}
