/* Leaves on ellipsoids, in words that C and GLSL share: lod/leaf.h and client-min/draw/view_shader.c include this text.
 * Before it both say what LEAF, real(x), whole(x), uint, floor and sqrt are. It is the argument of a macro, which C takes
 * as it is and a shader as a string; hence no directives. */
LOD_LEAF_TEXT(
/* A splat in its plant's space, in cells: the point (u, v, s) of the unit ball is at x + xu u + xv v + xs s and so
 * on. ragged: what the squares of the shells' radii differ by. amount: contrast that is left, 0 to 1. */
struct leaf_splat { float x, xu, xv, xs, y, yu, yv, ys, z, zu, zv, zs, ragged, opacity, amount; };

LEAF uint leaf_mix(uint h)
{
	h = (h ^ h >> 16) * 0x21F0AAADu;
	h = (h ^ h >> 15) * 0x735A2D97u;
	return h ^ h >> 15;
}

/* One of a cell's numbers in [0, 1). */
LEAF float leaf_unit(uint cell, uint number)
{
	return real(leaf_mix(cell + number * 0x9E3779B9u) >> 8) / 16777216.0f;
}

/* The cell that holds a point. Cells surround the points of a body-centred lattice: cuts through them are blobs in all
 * directions, where those of cubes would be squares. */
LEAF uint leaf_cell(float x, float y, float z)
{
	float i = floor(x + 0.5f), j = floor(y + 0.5f), k = floor(z + 0.5f);
	float l = floor(x) + 0.5f, m = floor(y) + 0.5f, n = floor(z) + 0.5f;
	bool other = (x - l) * (x - l) + (y - m) * (y - m) + (z - n) * (z - n)
		< (x - i) * (x - i) + (y - j) * (y - j) + (z - k) * (z - k);
	return leaf_mix(whole(2.0f * (other ? l : i)) * 0x9E3779B1u ^ whole(2.0f * (other ? m : j)) * 0x85EBCA77u
		^ whole(2.0f * (other ? n : k)) * 0xC2B2AE3Du);
}

/* The square of the height of a shell over (u, v): of shells 1 to 3 a third of all lines of sight ends on each. */
LEAF float leaf_height2(leaf_splat splat, uint shell, float u, float v)
{
	return 1.0f + splat.ragged * (2.0f - real(shell)) - u * u - v * v;
}

/* The leaf at (u, v): its cell, the amount in 1/255 << 2 and the shell. 0: none. */
LEAF uint leaf_at(leaf_splat splat, float u, float v)
{
	for (uint shell = 1u; shell <= 3u; shell++) {
		float height2 = leaf_height2(splat, shell, u, v);
		if (!(height2 >= 0.0f))
			return 0u;
		float s = sqrt(height2);
		uint cell = leaf_cell(splat.x + splat.xu * u + splat.xv * v + splat.xs * s,
			splat.y + splat.yu * u + splat.yv * v + splat.ys * s,
			splat.z + splat.zu * u + splat.zv * v + splat.zs * s);
		if (leaf_unit(cell, shell) * real(4u - shell) < 1.0f)
			return leaf_unit(cell, 4u) < splat.opacity ? (cell & 0xFFFFFC00u)
				| whole(splat.amount * 255.0f + 0.5f) << 2 | shell : 0u;
	}
	return 0u;
}

LEAF float leaf_amount(uint leaf) { return real(leaf >> 2 & 255u) / 255.0f; }

/* Whether it is lit as a leaf, and not as the mean of many; and that leaf is turned as the ellipsoid is, or as any. */
LEAF bool leaf_is_lit(uint leaf) { return leaf_unit(leaf, 5u) < leaf_amount(leaf); }

/* Whether that leaf is turned as the mean (as its ellipsoid; of a cloud, level) or anyhow, and a coordinate of a vector of
 * any direction. The normal of a leaf that is seen is the unit vector of that, plus the direction to the eye: so leaves
 * count by the area that they show. */
LEAF bool leaf_is_mean(uint leaf, float share) { return leaf_unit(leaf, 6u) < share; }

LEAF float leaf_turn(uint leaf, uint axis)
{
	uint h = leaf_mix(leaf + (8u + axis) * 0x9E3779B9u);
	return real((h & 65535u) + (h >> 16)) / 65535.5f - 1.0f;
}

/* The share of a cloud's seen area that lies level; view_light.glsl has the same mean. rise: of the direction to the eye. */
LEAF float leaf_level(float level, float rise)
{
	float lying = level * (rise < 0.0f ? -rise : rise);
	return lying / (lying + max(0.5f * (1.0f - level), 1e-3f));
}

/* Factor of a leaf's own light. */
LEAF float leaf_tone(uint leaf, float deviation)
{
	return max(1.0f + 1.7320508f * deviation * leaf_amount(leaf) * (2.0f * leaf_unit(leaf, 7u) - 1.0f), 0.0f);
}
)
