/* The queue of plans: whose turn it is, and how much of it one address may have. */
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include "server/work.h"
#include "tests/support/unit_test.h"

static pthread_mutex_t closed = PTHREAD_MUTEX_INITIALIZER;
static char order[32];

static void wait_at_door(void *argument)
{
	pthread_mutex_lock(&closed);
	pthread_mutex_unlock(&closed);
}

static void note(void *argument)
{
	strcat(order, argument);
}

static void do_nothing(void *argument)
{
}

static struct srv_job job_of(char who, const char *name, atomic_bool *cancelled)
{
	struct srv_job job = { .run = name ? note : wait_at_door, .finish = do_nothing,
		.argument = (void *)name, .cancelled = cancelled };
	job.owner.bytes[0] = (uint8_t)who;
	return job;
}

/* One thread, held at a job, with room for `capacity` more. */
static struct srv_work *start_held(uint32_t capacity, uint32_t share, atomic_bool *cancelled)
{
	struct srv_work *work;
	struct eco_error error = { 0 };
	struct srv_job first = job_of('x', NULL, cancelled);
	order[0] = 0;
	pthread_mutex_lock(&closed);
	assert_ok(srv_work_start(&work, 1, capacity, share, &error), error);
	assert_true(srv_work_submit(work, &first));
	usleep(50000);                           /* until it is taken from the queue */
	return work;
}

UNIT_TEST(addresses_are_served_in_turn)
{
	static const char *const names[] = { "a", "a", "a", "a", "b", "c", "c", "b", "d" };
	static atomic_bool cancelled;
	struct srv_work *work = start_held(20, 20, &cancelled);
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		struct srv_job job = job_of(names[i][0], names[i], &cancelled);
		assert_true(srv_work_submit(work, &job));
	}
	pthread_mutex_unlock(&closed);
	srv_work_free(work);
	assert_string_equal(order, "abcdacbaa");
}

UNIT_TEST(no_address_has_more_than_its_share)
{
	static atomic_bool cancelled;
	struct srv_work *work = start_held(5, 3, &cancelled);
	struct srv_job a = job_of('a', "a", &cancelled), b = job_of('b', "b", &cancelled);
	for (int i = 0; i < 5; i++)
		assert_int_equal(srv_work_submit(work, &a), i < 3);
	for (int i = 0; i < 3; i++)
		assert_int_equal(srv_work_submit(work, &b), i < 2);
	pthread_mutex_unlock(&closed);
	srv_work_free(work);
	assert_string_equal(order, "ababa");
}

static void wait_for_flag(void *argument)
{
	const atomic_bool *flag = argument;
	while (!atomic_load(flag))
		usleep(1000);
}

UNIT_TEST(who_stops_ends_what_runs_and_what_waits)
{
	static atomic_bool running, waiting;
	struct srv_work *work;
	struct eco_error error = { 0 };
	struct srv_job first = { .run = wait_for_flag, .finish = do_nothing, .argument = &running,
		.cancelled = &running }, second = first;
	second.argument = second.cancelled = &waiting;
	assert_ok(srv_work_start(&work, 1, 4, 4, &error), error);
	assert_true(srv_work_submit(work, &first) && srv_work_submit(work, &second));
	srv_work_free(work);
	assert_true(atomic_load(&running) && atomic_load(&waiting));
}

int main(void)
{
	return unit_tests_run(NULL, NULL);
}
