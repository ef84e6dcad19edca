
#include <math.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/base/status.h"
#include "ecofiles/base/angle16.h"
#include "tests/support/unit_test.h"

UNIT_TEST(every_turn_is_the_sine_within_an_ulp)
{
	for (uint32_t turn = 0; turn < 65536; turn++) {
		double sine, cosine, radians = turn * (2 * 3.14159265358979323846 / 65536);
		eco_angle16_sincos((uint16_t)turn, &sine, &cosine);
		assert_true(fabs(sine - sin(radians)) < 1e-15);
		assert_true(fabs(cosine - cos(radians)) < 1e-15);
		assert_true(fabs(sine * sine + cosine * cosine - 1) < 1e-15);
	}
}

/* The same bits on every machine: a hash over all results. */
UNIT_TEST(results_are_the_golden_ones)
{
	static double all[2 * 65536];
	static const uint8_t golden[16] = { 0x3b, 0xb8, 0x17, 0xee, 0x80, 0xd3, 0x29, 0xea, 0xac, 0xd0, 0xa8,
		0x00, 0xec, 0x92, 0xa3, 0xa6 };
	struct eco_chunk_id id;
	for (uint32_t turn = 0; turn < 65536; turn++)
		eco_angle16_sincos((uint16_t)turn, &all[2 * turn], &all[2 * turn + 1]);
	id = eco_chunk_hash((const uint8_t *)all, sizeof all);
	assert_memory_equal(id.bytes, golden, sizeof golden);
}

UNIT_TEST(degrees_go_to_the_nearest_step)
{
	static const struct { double degrees; uint16_t turn; } cases[] = {
		{ 0, 0 }, { 90, 16384 }, { -90, 49152 }, { 360, 0 }, { 450, 16384 }, { -720, 0 },
			{ 45, 8192 },
		{ 180, 32768 },
		{ 0.002746, 0 }, { 0.002747, 1 }, { 359.9999, 0 }, { -0.0001, 0 },
	};

	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		assert_int_equal(eco_angle16_from_deg(cases[i].degrees), cases[i].turn);
	/* Large angles give some step and no undefined conversion. */
	(void)eco_angle16_from_deg(1e300);
	(void)eco_angle16_from_deg(-1e300);
}

UNIT_TEST(the_first_error_wins)
{
	struct eco_error error = { 0 };
	assert_int_equal(eco_fail(&error, ECO_DAMAGED, "%s %d", "first", 1), ECO_DAMAGED);
	assert_int_equal(eco_fail(&error, ECO_IO, "second"), ECO_IO);
	assert_int_equal(error.code, ECO_DAMAGED);
	assert_string_equal(error.text, "first 1");
	assert_int_equal(eco_fail(NULL, ECO_IO, "nowhere"), ECO_IO);
}

UNIT_TEST(every_code_has_a_name_and_an_exit_status)
{
	for (int code = 0; code < ECO_CODE_COUNT; code++) {
		assert_true(strlen(eco_code_name(code)) > 0);
		assert_int_equal(eco_exit_status(code), code == ECO_OK ? 0 : code == ECO_BAD_USAGE ? 2 : 1);
	}
	assert_string_equal(eco_code_name(ECO_CODE_COUNT), "unknown");
}
