// ecoimage.so: OpenImageIO behind a C function. Exceptions end here.
#include "ecofiles/base/module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <vector>

using namespace OIIO;

namespace {

int fail(char *text, size_t size, const std::string &why)
{
	std::snprintf(text, size, "%s", why.empty() ? "it is not a picture that can be read" : why.c_str());
	for (char *c = text; *c != 0; c++)
		if (*c == '\n')
			*c = ' ';
	return 1;
}

std::string last_error(ImageInput *input)
{
	std::string why = input != nullptr ? input->geterror() : OIIO::geterror();

	OIIO::geterror();
	return why;
}

// Fetches rows of `channels` 8-bit samples and spreads gray and missing alpha over RGBA.
int read_rgba(ImageInput &input, uint64_t pixels_max, uint32_t *width, uint32_t *height, uint8_t **rgba,
char *text, size_t size)
{
	const ImageSpec spec = input.spec();

	if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1)
		return fail(text, size, "it has no flat pixels");
	if (uint64_t(spec.width) * uint64_t(spec.height) > pixels_max)
		return fail(text, size, std::to_string(spec.width) + "x" + std::to_string(spec.height)
			+ " pixels, at most "
			+ std::to_string(pixels_max) + " are possible");
	const int channels = spec.nchannels > 4 ? 4 : spec.nchannels;
	const size_t pixels = size_t(spec.width) * size_t(spec.height);
	std::vector<uint8_t> row(pixels * size_t(channels));
	std::unique_ptr<uint8_t, decltype(&std::free)> out(static_cast<uint8_t *>(std::malloc(pixels * 4)),
		&std::free);

	if (!out)
		return fail(text, size, "out of memory");
	if (!input.read_image(0, 0, 0, channels, TypeDesc::UINT8, row.data()))
		return fail(text, size, last_error(&input));
	// Some readers (WebP) multiply colours by alpha whatever was asked, and omit the attribute.
	const bool straight = spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
	const bool has_alpha = channels == 2
		|| (channels == 4 && (spec.alpha_channel == 3 || spec.alpha_channel < 0));
	for (size_t i = 0; i < pixels; i++) {
		const uint8_t *from = &row[i * size_t(channels)];
		uint8_t *to = out.get() + i * 4;
		for (int c = 0; c < 3; c++)
			to[c] = channels >= 3 ? from[c] : from[0];
		to[3] = has_alpha ? from[channels - 1] : 255;
		for (int c = 0; c < 3 && !straight && to[3] != 0; c++)
			to[c] = uint8_t(std::min(255, (to[c] * 255 + to[3] / 2) / to[3]));
	}
	*width = uint32_t(spec.width);
	*height = uint32_t(spec.height);
	*rgba = out.release();
	return 0;
}

int decode(const char *name, const void *bytes, size_t size, uint64_t pixels_max, uint32_t *width,
	uint32_t *height, uint8_t **rgba, char *text, size_t text_size)
{
	try {
		ImageSpec config;
		std::unique_ptr<Filesystem::IOMemReader> memory;

		config.attribute("oiio:UnassociatedAlpha", 1);
		if (bytes != nullptr) {
			memory.reset(new Filesystem::IOMemReader(const_cast<void *>(bytes), size));
			Filesystem::IOProxy *proxy = memory.get();
			config.attribute("oiio:ioproxy", TypeDesc::PTR, &proxy);
		}
		auto input = ImageInput::open(name, &config, memory.get());
		if (!input)
			return fail(text, text_size, last_error(nullptr));
		return read_rgba(*input, pixels_max, width, height, rgba, text, text_size);
	} catch (const std::exception &problem) {
		return fail(text, text_size, problem.what());
	} catch (...) {
		return fail(text, text_size, "OpenImageIO failed");
	}
}

} // namespace

// One thread: the callers decide about threads, and a thread pool would not survive the fork of a guarded
// import.
__attribute__((constructor)) static void start()
{
	OIIO::attribute("threads", 1);
	OIIO::attribute("exr_threads", -1);
}

extern "C" ECO_MODULE_EXPORT const struct eco_image_module eco_image_module =
	{ ECO_MODULE_VERSION, decode };
