/* Union-find over numbers: parent[i] = i at first. The smaller root wins, so that a set is named by its
 * first member whatever the order of joining. */
#pragma once

#include <stdint.h>

static inline uint32_t eco_union_root(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

static inline void eco_union_join(uint32_t *parent, uint32_t a, uint32_t b)
{
	a = eco_union_root(parent, a);
	b = eco_union_root(parent, b);
	parent[a < b ? b : a] = a < b ? a : b;
}
