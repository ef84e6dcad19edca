/* Leaves on ellipsoids, in words that C and GLSL share: lod/leaf.h and client-min/draw/view_shader.c include this text.
 * Before it both say what LEAF, real(x), whole(x), uint, floor, max and sqrt are. It is the argument of a macro, which C
 * takes as it is and a shader as a string; hence no directives. */
LOD_LEAF_TEXT(
/* A splat in its plant's space, in cells: the point (u, v, s) of the unit ball is at x + xu u + xv v + xs s and so
 * on. ragged: what the squares of the shells' radii differ by. amount: a leaf's width in cells, at most 1. A larger cell
 * stands for the mean of 1 / amount^2 leaves, whose deviation is that part of one's: tones deviate less, and only that
 * share of cells is drawn as a leaf, the others anew in each of a pixel's samples. */
struct leaf_splat { float x, xu, xv, xs, y, yu, yv, ys, z, zu, zv, zs, ragged, opacity, amount; uint nth; };

/* One product: numbers of neighbours correlate by at most .011, which no picture shows. */
LEAF uint leaf_mix(uint h)
{
	h = (h ^ h >> 15) * 0x735A2D97u;
	return h ^ h >> 15;
}

/* The hash of the cell that holds a point. Cells surround the points of a body-centred lattice: cuts through them are
 * blobs in all directions, where those of cubes would be squares. */
LEAF uint leaf_cell(float x, float y, float z)
{
	float i = floor(x + 0.5f), j = floor(y + 0.5f), k = floor(z + 0.5f);
	float l = floor(x) + 0.5f, m = floor(y) + 0.5f, n = floor(z) + 0.5f;
	bool other = abs(x - i) + abs(y - j) + abs(z - k) > 0.75f;
	return leaf_mix(whole(2.0f * (other ? l : i)) * 0x9E3779B1u ^ whole(2.0f * (other ? m : j)) * 0x85EBCA77u
		^ whole(2.0f * (other ? n : k)) * 0xC2B2AE3Du);
}

/* `ragged`, but 0 where the ellipse's radius is so few pixels that its rim is less than one: such a rim costs pixels
 * and shows nothing. */
LEAF float leaf_rim(float ragged, float radius) { return ragged * radius < 1.0f ? 0.0f : ragged; }

/* The hash of what is drawn in a cell. Cells that are no leaf are drawn anew by the nth of samples, splats and
 * plants: from afar few cells decide how much a plant covers, and plants of a kind must not all lack the same. */
LEAF uint leaf_drawn(uint cell, float amount, uint nth)
{
	return real(cell >> 24) < 256.0f * amount * amount ? cell : leaf_mix(cell + nth * 0x27D4EB2Fu);
}

/* In [0, 1): less than what opacity a cell needs in order to be covered. */
LEAF float leaf_need(uint drawn) { return real(drawn >> 10 & 255u) / 256.0f; }

/* A surface without shells has this leaf in a cell. */
LEAF uint leaf_in(uint cell, float amount)
{
	return (cell & 0xFFFFFC00u) | whole(amount * 255.0f + 0.5f) << 2 | 2u;
}

/* The square of the height of shell 1, 2 or 3 over (u, v): the second is the ellipsoid. */
LEAF float leaf_height2(leaf_splat splat, uint shell, float u, float v)
{
	return 1.0f + splat.ragged * (2.0f - real(shell)) - u * u - v * v;
}

/* The leaf at (u, v): its cell, the amount in 1/255 << 2 and the shell; a third of all cells is on each. 0: none. */
LEAF uint leaf_at(leaf_splat splat, float u, float v)
{
	float s = sqrt(max(1.0f - u * u - v * v, 0.0f));
	uint cell = leaf_cell(splat.x + splat.xu * u + splat.xv * v + splat.xs * s,
		splat.y + splat.yu * u + splat.yv * v + splat.ys * s, splat.z + splat.zu * u + splat.zv * v + splat.zs * s);
	uint one = leaf_drawn(cell, splat.amount, splat.nth);
	uint shell = ((one & 1023u) * 3u >> 10) + 1u;
	return leaf_height2(splat, shell, u, v) >= 0.0f && leaf_need(one) < splat.opacity
		? (cell & 0xFFFFFC00u) | whole(splat.amount * 255.0f + 0.5f) << 2 | shell : 0u;
}

LEAF float leaf_amount(uint leaf) { return real(leaf >> 2 & 255u) / 255.0f; }

/* Numbers of its cell that say how it looks: 10 bits of tone, 8 of light, 10 of its turn; and 30 of its direction. */
LEAF uint leaf_look(uint leaf) { return leaf_mix(leaf >> 10); }
LEAF uint leaf_side(uint look) { return leaf_mix(look); }

/* Factor of a leaf's own light. */
LEAF float leaf_tone(uint leaf, uint look, float deviation)
{
	return max(1.0f + 1.7320508f * deviation * leaf_amount(leaf) * (real(look & 1023u) / 511.5f - 1.0f), 0.0f);
}

/* Whether it is lit as a leaf, and not as the mean of many; and how that leaf is turned: level, or of
 * an ellipsoid half of the others as its surface, or anyhow, as `side` says: the normal of a leaf that is seen is the unit vector of any
 * direction plus the direction to the eye. So leaves count by the area that they show. */
LEAF bool leaf_is_lit(uint leaf, uint look) 
{
	return real(look >> 10 & 255u) < 256.0f * leaf_amount(leaf) * leaf_amount(leaf);
}

LEAF bool leaf_is_surface(uint look) { return look >> 31 == 0u; }
LEAF bool leaf_is_level(uint look, float share) { return real(look >> 18 & 511u) < 512.0f * share; }

/* A coordinate of the direction, of which sums of two numbers make all nearly alike. */
LEAF float leaf_turn(uint side, uint axis)
{
	uint bits = side >> 10u * axis;
	return real((bits & 31u) + (bits >> 5 & 31u)) - 30.99f;
}

/* The share of a cloud's seen area that lies level; view_light.glsl has the same mean. rise: of the direction to the eye. */
LEAF float leaf_level(float level, float rise)
{
	float lying = level * (rise < 0.0f ? -rise : rise);
	return lying / (lying + max(0.5f * (1.0f - level), 1e-3f));
}
)
