#include "tests/support/gltf_writer.h"

static struct {
	uint8_t bytes[1 << 21];
	char views[60000], accessors[20000], json[120000];
	size_t size;
	int view_count, accessor_count;
} gw;

void gw_begin(void)
{
	gw.size = 0;
	gw.views[0] = gw.accessors[0] = gw.json[0] = 0;
	gw.view_count = gw.accessor_count = 0;
}

static void gw_append(char *to, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));
static void gw_append(char *to, size_t size, const char *format, ...)
{
	size_t used = strlen(to);
	va_list arguments;
	va_start(arguments, format);
	if (vsnprintf(to + used, size - used, format, arguments) >= (int)(size - used))
		abort();
	va_end(arguments);
}

/* Offset of the bytes in the buffer, a multiple of four. */
static size_t gw_put(const void *bytes, size_t size)
{
	size_t at = gw.size = (gw.size + 3) & ~(size_t)3;
	if (at + size > sizeof gw.bytes)
		abort();
	memcpy(gw.bytes + at, bytes, size);
	gw.size += size;
	return at;
}

int gw_view(const void *bytes, size_t size, const char *more)
{
	size_t at = gw_put(bytes, size);
	gw_append(gw.views, sizeof gw.views, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu%s}",
		gw.view_count > 0 ? "," : "", at, size, more);
	return gw.view_count++;
}

int gw_packed(const void *bytes, size_t size, size_t count, size_t stride, const char *mode,
	const char *filter, const char *extension)
{
	size_t at = gw_put(bytes, size);
	gw_append(gw.views, sizeof gw.views, "%s{\"buffer\":1,\"byteLength\":%zu,"
		"\"extensions\":{\"%s\":{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,"
		"\"byteStride\":%zu,\"count\":%zu,\"mode\":\"%s\",\"filter\":\"%s\"}}}",
		gw.view_count > 0 ? "," : "", count * stride, extension, at, size, stride, count, mode,
		filter);
	return gw.view_count++;
}

int gw_accessor(int view, int type, size_t count, const char *kind, const char *more)
{
	gw_append(gw.accessors, sizeof gw.accessors, "%s{\"componentType\":%d,\"count\":%zu,"
		"\"type\":\"%s\"%s", gw.accessor_count > 0 ? "," : "", type, count, kind, more);
	if (view >= 0)
		gw_append(gw.accessors, sizeof gw.accessors, ",\"bufferView\":%d", view);
	gw_append(gw.accessors, sizeof gw.accessors, "}");
	return gw.accessor_count++;
}

int gw_floats(const float *values, size_t count, const char *kind, size_t components)
{
	return gw_accessor(gw_view(values, count * components * sizeof *values, ""), GLTF_FLOAT, count, kind,
		"");
}

const char *gw_json(const char *buffer, const char *rest)
{
	gw.json[0] = 0;
	gw_append(gw.json, sizeof gw.json, "{\"asset\":{\"version\":\"2.0\"},"
		"\"buffers\":[{\"byteLength\":%zu%s},{\"byteLength\":1048576,\"extensions\":"
		"{\"EXT_meshopt_compression\":{\"fallback\":true}}}],\"bufferViews\":[%s],"
		"\"accessors\":[%s]%s}", gw.size, buffer, gw.views, gw.accessors, rest);
	for (char *at = gw.json; (at = strchr(at, '\'')); )
		*at = '"';
	return gw.json;
}

size_t gw_glb_bytes(const char *rest, char pad, uint8_t **bytes)
{
	const char *json = gw_json("", rest);
	size_t length = strlen(json), padded = (length + 4) & ~(size_t)3, binary = (gw.size + 3) & ~(size_t)3,
		size = 28 + padded + binary;
	uint32_t words[7] = { 0x46546c67, 2, (uint32_t)size, (uint32_t)padded, 0x4e4f534a, (uint32_t)binary,
		0x004e4942 };
	uint8_t *to = *bytes = malloc(size);
	if (!to)
		abort();
	memcpy(to, words, 20);
	memset(to + 20, pad, padded);
	memcpy(to + 20, json, length);
	memcpy(to + 20 + padded, &words[5], 8);
	memset(to + 28 + padded, 0, binary);
	memcpy(to + 28 + padded, gw.bytes, gw.size);
	return size;
}
