/* Where a scene stands, how it is looked at and when: extreme places, cameras and times. */
#include "tests/extreme_test.h"

extern const struct extreme_family extreme_place, extreme_camera, extreme_time;

int main(void)
{
	return extreme_test((const struct extreme_family *const[]){ &extreme_place, &extreme_camera, &extreme_time }, 3);
}
