/* The queue of plans: whose turn it is, how much of it one address may have, and who gives way to a newcomer. */
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include "server/work.h"
#include "tests/support/cases.h"
#include "tests/support/unit_test.h"

static pthread_mutex_t closed = PTHREAD_MUTEX_INITIALIZER;
static char order[200], displaced[200];

static void wait_at_door(void *argument)
{
	pthread_mutex_lock(&closed);
	pthread_mutex_unlock(&closed);
}

static void note(void *argument)
{
	static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
	pthread_mutex_lock(&mutex);
	strcat(order, argument);
	pthread_mutex_unlock(&mutex);
}

static void note_displaced(void *argument)
{
	strcat(displaced, argument);
}

static void do_nothing(void *argument)
{
}

static struct srv_job job_of(char who, const char *name, atomic_bool *cancelled)
{
	struct srv_job job = { .run = name ? note : wait_at_door, .finish = do_nothing,
		.displaced = note_displaced, .argument = (void *)name, .cancelled = cancelled };
	job.owner.bytes[0] = (uint8_t)who;
	return job;
}

/* One thread, held at a job, with room for `capacity` more. */
static struct srv_work *start_held(uint32_t capacity, uint32_t share, atomic_bool *cancelled)
{
	struct srv_work *work;
	struct srv_job first = job_of('x', NULL, cancelled);
	order[0] = displaced[0] = 0;
	pthread_mutex_lock(&closed);
	assert_good(srv_work_start(&work, 1, false, capacity, share, &cause));
	assert_true(srv_work_submit(work, &first));
	while (srv_work_waiting(work))           /* until it is taken from the queue */
		usleep(1000);
	return work;
}

static bool submit(struct srv_work *work, const char *name)
{
	static atomic_bool cancelled;
	struct srv_job job = job_of(name[0], name, &cancelled);
	return srv_work_submit(work, &job);
}

static void open_and_free(struct srv_work *work)
{
	pthread_mutex_unlock(&closed);
	srv_work_free(work);
}

/* Jobs as they come, by address and number; '+' in front of those that are accepted. */
UNIT_TEST(addresses_share_the_queue)
{
	struct row { uint32_t capacity, share; const char *jobs, *displaced, *order; };
	uint32_t count;
	const struct row *rows = cases_rows("tests/server/cases/queue.tsv", "uusss", sizeof *rows, &count);
	static atomic_bool cancelled;
	for (size_t r = 0; r < count; r++) {
		struct srv_work *work = start_held(rows[r].capacity, rows[r].share, &cancelled);
		char jobs[64];
		strcpy(jobs, rows[r].jobs);
		for (char *job = strtok(jobs, " "); job; job = strtok(NULL, " ")) {
			assert_true(*job == '-' || srv_work_has_room(work));
			assert_int_equal(submit(work, job + 1), *job == '+');
		}
		assert_string_equal(displaced, rows[r].displaced);
		open_and_free(work);
		assert_string_equal(order, rows[r].order);
	}
}

/* The server's defaults, full of what few or many addresses ask for. A newcomer comes in, and waits for at
 * most one job of those that hold more; for one job each of those that hold as little. */
UNIT_TEST(no_crowd_keeps_a_newcomer_waiting)
{
	static const struct { int addresses, jobs; size_t ahead; } crowds[] = { { 1, 32, 1 }, { 2, 32, 1 },
		{ 3, 32, 1 }, { 8, 32, 1 }, { 13, 5, 1 }, { 20, 5, 1 }, { 32, 2, 2 }, { 50, 2, 50 } };
	static atomic_bool cancelled;
	for (size_t c = 0; c < sizeof crowds / sizeof *crowds; c++) {
		struct srv_work *work = start_held(64, 32, &cancelled);
		for (int i = 0; i < crowds[c].addresses * crowds[c].jobs; i++) {
			struct srv_job job = job_of((char)('A' + i % crowds[c].addresses), "-", &cancelled);
			srv_work_submit(work, &job);
		}
		assert_true(srv_work_has_room(work) && submit(work, "!"));
		assert_in_range(srv_work_waiting(work), 1, 64);
		open_and_free(work);
		assert_in_range(strcspn(order, "!"), 0, crowds[c].ahead);
	}
}

static void raise_flag(void *argument)
{
	atomic_store((atomic_bool *)argument, true);
}

/* One thread is held by a job of a crowd that has more. The other takes the job of an address that holds no
 * other, and nothing of the crowd. */
UNIT_TEST(the_spare_thread_is_for_who_holds_nothing)
{
	static atomic_bool cancelled, done;
	struct srv_work *work;
	struct srv_job crowd = job_of('a', NULL, &cancelled), note_crowd = job_of('a', "a", &cancelled),
		other = { .run = raise_flag, .finish = do_nothing, .argument = &done,
		.cancelled = &cancelled };
	order[0] = 0;
	pthread_mutex_lock(&closed);
	assert_good(srv_work_start(&work, 1, true, 5, 5, &cause));
	usleep(50000);                           /* until both wait */
	assert_true(srv_work_submit(work, &crowd));
	for (int i = 0; i < 3; i++)
		assert_true(srv_work_submit(work, &note_crowd));
	assert_true(srv_work_submit(work, &other));
	while (!atomic_load(&done))
		usleep(1000);
	assert_string_equal(order, "");
	open_and_free(work);
	assert_string_equal(order, "aaa");
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
	struct srv_job first = { .run = wait_for_flag, .finish = do_nothing, .argument = &running,
		.cancelled = &running }, second = first;
	second.argument = second.cancelled = &waiting;
	assert_good(srv_work_start(&work, 1, false, 4, 4, &cause));
	assert_true(srv_work_submit(work, &first) && srv_work_submit(work, &second));
	srv_work_free(work);
	assert_true(atomic_load(&running) && atomic_load(&waiting));
}
