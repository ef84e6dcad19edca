/* Camera scripts: whatever parses gives frames in ascending time that can be drawn. */
#include <assert.h>
#include <string.h>

#include "ecofiles/format/view.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct eco_camera *camera;
	struct eco_error error = { 0 };
	enum eco_code code = eco_camera_parse(&camera, (const char *)bytes, size, "camera.json", &error);
	assert(code == error.code && (code == ECO_OK) == (camera != NULL));
	if (code)
		return 0;
	uint32_t count = eco_camera_frame_count(camera), step = count / 100 + 1;
	double before = 0;
	assert(count > 0);
	for (uint32_t i = 0; i < count; i += step) {
		struct eco_view view = { .width = 4, .height = 3 };
		double time_s = eco_camera_frame(camera, i, &view);
		assert(i == 0 || time_s > before);
		assert(eco_view_check(&view, NULL) == ECO_OK);
		before = time_s;
	}
	eco_camera_free(camera);
	return 0;
}
