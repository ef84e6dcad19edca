#include "server/trace.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "server/log.h"

static const struct { const char *name, *text; } trace_rows[] = {
#define X(bit, name, text) { name, text },
	SRV_TRACE_BITS(X)
#undef X
};

static uint32_t trace_bits;      /* written before threads start */
static _Thread_local struct eco_writer *captured;

static enum eco_code unknown(const char *name, size_t size, struct eco_error *error)
{
	char list[400] = "";
	for (size_t i = 0, at = 0; i < SRV_TRACE_COUNT && at < sizeof list; i++)
		at += (size_t)snprintf(list + at, sizeof list - at, "%s %s (%s)", i ? "," : "",
			trace_rows[i].name, trace_rows[i].text);
	return eco_fail(error, ECO_BAD_USAGE, "ECO_TRACE: there is no '%.*s'; known are%s",
		(int)(size < 40 ? size : 40), name, list);
}

enum eco_code srv_trace_set(const char *names, struct eco_error *error)
{
	trace_bits = 0;
	for (const char *at = names; at && *at;) {
		size_t size = strcspn(at, ","), i = 0;
		while (i < SRV_TRACE_COUNT
			&& (strlen(trace_rows[i].name) != size || memcmp(trace_rows[i].name, at, size) != 0))
			i++;
		if (i == SRV_TRACE_COUNT)
			return unknown(at, size, error);
		trace_bits |= 1u << i;
		at += size + (at[size] == ',');
	}
	return ECO_OK;
}

void srv_trace_capture(struct eco_writer *to) { captured = to; }

bool srv_trace_on(enum srv_trace_bit bit) { return trace_bits >> bit & 1; }

void srv_trace(enum srv_trace_bit bit, const char *format, ...)
{
	char line[512];
	bool captures = bit == SRV_TRACE_PLAN && captured;
	if (!srv_trace_on(bit) && !captures)
		return;
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(line, sizeof line, format, arguments);
	va_end(arguments);
	if (captures) {
		eco_write_bytes(captured, line, strlen(line));
		eco_write_u8(captured, '\n');
	}
	if (srv_trace_on(bit))
		srv_log_event(SRV_LOG_TEXT, false, "%s: %s", trace_rows[bit].name, line);
}
