/* The image on the ground, in words that C and GLSL share: view_image.c includes this text, and the client in
 * a browser compiles it as a part of a shader (client-min/web/web_light.glsl), so that there is one definition
 * of both. The rules of draw/view_light.glsl hold. Before it both say what tree and wide are, after it what
 * is in a tree. Places and widths are in sides of the root, from its south-west corner: wide numbers have as
 * many digits as the language has, as the smallest texel of a large image is a small part of its root. */

#define LEAF 0x80000000u
#define SAMPLES_MAX 6.0f

/* light is times alpha while it is summed, as light under clear texels does not count; texel: how wide those
 * are that were looked at. */
struct image_color { float red, green, blue, alpha, texel; };
/* The tile at a place, a leaf of the tree (0: none), its side, and the place within it, in its sides. */
struct image_spot { uint leaf; float side, x, y; };
/* The place that a pixel shows: its middle, and half its extents along and across where it is longest. */
struct image_pixel { wide x, y; float along_x, along_y, across; };

/* Word i of view_image.nodes. */
LIGHT uint tree_node(tree t, uint i);
/* A level of a leaf's tile, and a texel of it, of light times alpha; rows from the north. */
LIGHT uint tree_level(tree t, uint leaf, uint level);
LIGHT image_color tree_texel(tree t, uint of, uint texel);

LIGHT image_color image_add(image_color sum, image_color c, float weight)
{
	return image_color(sum.red + weight * c.red, sum.green + weight * c.green,
		sum.blue + weight * c.blue, sum.alpha + weight * c.alpha, sum.texel);
}

LIGHT image_spot image_find(tree t, wide x, wide y)
{
	wide none = widened(0.0f), one = widened(1.0f), u = x, v = y;
	float side = 1.0f;
	uint node = u >= none && v >= none && u < one && v < one ? tree_node(t, 0u) : 0u;
	while (node != 0u && node < LEAF) {
		u += u;
		v += v;
		side *= 0.5f;
		node += (u < one ? 0u : 1u) + (v < one ? 0u : 2u);
		u -= u < one ? none : one;
		v -= v < one ? none : one;
		node = tree_node(t, node);
	}
	return image_spot(node, side, real(u), real(v));
}

/* Spot of a place (x, y) at that distance from `at`: mostly in the same tile. */
LIGHT image_spot image_beside(tree t, image_spot at, float east, float north, wide x, wide y)
{
	float u = at.x + east / at.side, v = at.y + north / at.side;
	if (u >= 0.0f && v >= 0.0f && u < 1.0f && v < 1.0f)
		return image_spot(at.leaf, at.side, u, v);
	return image_find(t, x, y);
}

LIGHT uint leaf_last(uint leaf) { return leaf >> 29 & 3u; }
LIGHT float level_width(uint level) { return real(32u << level); }

/* The finest level that is held and has texels of at least that width, else the coarsest. */
LIGHT uint image_level(image_spot at, float width)
{
	uint level = leaf_last(at.leaf);
	while (level > 0u && at.side / level_width(level) < width)
		level--;
	return level;
}

LIGHT float texel_at(float at, float width) { return max(min(floor(at), width - 1.0f), 0.0f); }

/* The texel beyond a tile's border: of the tile there, on the level whose texels are about as wide. */
LIGHT image_color image_beyond(tree t, wide x, wide y, float texel)
{
	image_spot at = image_find(t, x, y);
	if (at.leaf == 0u)
		return image_color(0.0f, 0.0f, 0.0f, 0.0f, 0.0f);
	uint level = image_level(at, 0.75f * texel);
	float width = level_width(level);
	return tree_texel(t, tree_level(t, at.leaf, level), whole(texel_at((1.0f - at.y) * width, width) * width
		+ texel_at(at.x * width, width)));
}

/* Four texels around a place, of one level of the tile that holds it. Those beyond its border come last:
 * drivers in software do for all pixels what a branch does for few, and loops end where none is left. */
LIGHT image_color image_mixed(tree t, wide x, wide y, image_spot at, uint level)
{
	float width = level_width(level), texel = at.side / width, u = at.x * width - 0.5f,
		v = (1.0f - at.y) * width - 0.5f, column = floor(u), row = floor(v);
	uint of = tree_level(t, at.leaf, level), beyond = 0u;
	image_color sum = image_color(0.0f, 0.0f, 0.0f, 0.0f, 0.0f);
	for (uint k = 0u; k < 4u; k++) {
		float c = column + real(k & 1u), r = row + real(k >> 1),
			weight = (1.0f - abs(u - c)) * (1.0f - abs(v - r));
		if (c >= 0.0f && r >= 0.0f && c < width && r < width)
			sum = image_add(sum, tree_texel(t, of, whole(r * width + c)), weight);
		else
			beyond |= 1u << k;
	}
	for (uint k = 0u; beyond >> k != 0u; k++) {
		float c = column + real(k & 1u), r = row + real(k >> 1),
			weight = real(beyond >> k & 1u) * (1.0f - abs(u - c)) * (1.0f - abs(v - r));
		sum = image_add(sum, image_beyond(t, x + widened((c - u) * texel),
			y + widened((v - r) * texel), texel), weight);
	}
	return sum;
}

/* Between the two levels whose texels are next to `width`. */
LIGHT image_color image_sample(tree t, wide x, wide y, image_spot at, float width)
{
	uint level = image_level(at, width);
	float coarse = at.side / level_width(level), share = min((2.0f * width - coarse) / coarse, 1.0f);
	image_color c = image_mixed(t, x, y, at, level);
	if (level == leaf_last(at.leaf) || share >= 1.0f)
		return c;
	c = image_add(image_color(0.0f, 0.0f, 0.0f, 0.0f, 0.0f), c, share);
	return image_add(c, image_mixed(t, x, y, at, level + 1u), 1.0f - share);
}

/* The mean over a pixel, as far as SAMPLES_MAX places along it have it. */
LIGHT image_color image_seen(tree t, image_pixel p)
{
	image_spot at = image_find(t, p.x, p.y);
	image_color sum = image_color(0.0f, 0.0f, 0.0f, 0.0f, at.side / level_width(leaf_last(at.leaf)));
	float along = sqrt(p.along_x * p.along_x + p.along_y * p.along_y),
		across = max(p.across, 0.5f * sum.texel), count = 1.0f;
	if (at.leaf == 0u)
		return sum;
	if (along > across)
		count = min(ceil(along / across), SAMPLES_MAX);
	float width = 2.0f * max(across, along / count);
	for (float i = 0.5f; i < count; i += 1.0f) {
		float far = 2.0f * i / count - 1.0f, east = far * p.along_x, north = far * p.along_y;
		wide x = p.x + widened(east), y = p.y + widened(north);
		image_spot there = image_beside(t, at, east, north, x, y);
		if (there.leaf != 0u)
			sum = image_add(sum, image_sample(t, x, y, there, width), 1.0f / count);
	}
	float part = sum.alpha > 0.0f ? 1.0f / sum.alpha : 0.0f;
	return image_color(sum.red * part, sum.green * part, sum.blue * part, sum.alpha, sum.texel);
}
