#include "server/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/request/json.h"

#define TARGET_BYTES 400u

/* One line by one write, so that lines of several threads do not mix. */
static void print_line(struct eco_writer *out)
{
	eco_write_u8(out, '\n');
	if (!out->failed)
		(void)!write(STDERR_FILENO, out->bytes, out->size);
	eco_writer_free(out);
}

/* What is printable; parameters that are named like a token have no value. */
static void clean_target(char to[TARGET_BYTES], const char *target)
{
	size_t size = 0;
	bool is_secret = false;
	for (const char *at = target; *at && size < TARGET_BYTES - 2; at++) {
		to[size++] = *at > 0x20 && *at < 0x7f ? *at : '?';
		if (*at == '?' || *at == '&') {
			const char *token = strstr(at, "token");
			is_secret = token && token < at + 1 + strcspn(at + 1, "=&");
		} else if (*at == '=' && is_secret) {
			to[size++] = '-';
			at += strcspn(at, "&") - 1;
		}
	}
	to[size] = 0;
}

static void add_time(struct srv_json *json)
{
	struct timespec now;
	struct tm utc;
	char text[40], part[8];
	clock_gettime(CLOCK_REALTIME, &now);
	gmtime_r(&now.tv_sec, &utc);
	strftime(text, sizeof text - sizeof part, "%Y-%m-%dT%H:%M:%S", &utc);
	snprintf(part, sizeof part, ".%03dZ", (int)(now.tv_nsec / 1000000));
	strcat(text, part);
	srv_json_key_text(json, "time", text);
}

/* Each line of it. */
static void add_trace(struct srv_json *json, const char *trace)
{
	char line[512];
	srv_json_key_open(json, "trace", '[');
	for (const char *at = trace; *at;) {
		size_t size = strcspn(at, "\n");
		snprintf(line, sizeof line, "%.*s", (int)size, at);
		srv_json_text(json, line);
		at += size + (at[size] == '\n');
	}
	srv_json_close(json, ']');
}

static void print_json(const struct srv_log_request *r, const char *target)
{
	struct srv_json json = { 0 };
	srv_json_open(&json, '{');
	add_time(&json);
	srv_json_key_text(&json, "event", r->trace ? "slow" : "request");
	srv_json_key_text(&json, "id", r->id);
	srv_json_key_text(&json, "client", r->client);
	srv_json_key_text(&json, "method", r->method);
	srv_json_key_text(&json, "target", target);
	if (r->scene)
		srv_json_key_text(&json, "scene", r->scene);
	srv_json_key_count(&json, "status", r->status);
	srv_json_key_count(&json, "bytes", r->bytes);
	srv_json_key_number(&json, "ms", r->ms);
	if (r->plan_ms > 0) {
		srv_json_key_number(&json, "plan_ms", r->plan_ms);
		srv_json_key_count(&json, "work", r->work);
		srv_json_key_bool(&json, "cut_short", r->cut_short);
	}
	if (r->trace)
		add_trace(&json, r->trace);
	srv_json_close(&json, '}');
	print_line(&json.out);
}

static void print_text(const struct srv_log_request *r, const char *target)
{
	struct eco_writer out = { 0 };
	char line[TARGET_BYTES + 400];
	int size = snprintf(line, sizeof line, "%s%s %s %s %u %llu %.3f ms id=%s", r->trace ? "slow: " : "",
		r->client, r->method, target, r->status, (unsigned long long)r->bytes, r->ms, r->id);
	eco_write_bytes(&out, line, (size_t)size);
	if (r->plan_ms > 0) {
		size = snprintf(line, sizeof line, " plan=%.3f ms work=%llu%s", r->plan_ms,
			(unsigned long long)r->work, r->cut_short ? " cut-short" : "");
		eco_write_bytes(&out, line, (size_t)size);
	}
	for (const char *at = r->trace; at && *at;) {
		size_t length = strcspn(at, "\n");
		eco_write_bytes(&out, "\n  ", 3);
		eco_write_bytes(&out, at, length);
		at += length + (at[length] == '\n');
	}
	print_line(&out);
}

void srv_log_request(enum srv_log_form form, const struct srv_log_request *request)
{
	char target[TARGET_BYTES];
	clean_target(target, request->target);
	(form == SRV_LOG_JSON ? print_json : print_text)(request, target);
}

void srv_log_event(enum srv_log_form form, bool problem, const char *format, ...)
{
	char text[4096];
	struct srv_json json = { 0 };
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	if (form == SRV_LOG_TEXT) {
		fprintf(stderr, "ecoserve: %s\n", text);
		return;
	}
	srv_json_open(&json, '{');
	add_time(&json);
	srv_json_key_text(&json, "event", problem ? "problem" : "daemon");
	srv_json_key_text(&json, "text", text);
	srv_json_close(&json, '}');
	print_line(&json.out);
}
