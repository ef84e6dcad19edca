// The only C++ of ecofiles that knows Draco. Draco's decoders allocate what a stream declares: so many
// attributes of so many components. So the decoders are subclassed at the points where Draco has read
// these declarations and not yet acted on them; there anything beyond what is expected is refused.
#include "ecofiles/format/chunk/draco_shim.h"

#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <unistd.h>
#include <vector>

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>

namespace {

enum eco_code refuse(struct eco_error *error, enum eco_code code, const char *what, const char *detail)
{
	return eco_fail(error, code, "Draco: %s%s%s", what, *detail ? ": " : "", detail);
}

// Runs `body` so that no exception leaves it.
template <class Body>
enum eco_code contained(struct eco_error *error, enum eco_code otherwise, Body body)
{
	try {
		return body();
	} catch (const std::bad_alloc &) {
		return refuse(error, ECO_NO_MEMORY, "out of memory", "");
	} catch (const std::exception &e) {
		return refuse(error, otherwise, "exception", e.what());
	} catch (...) {
		return refuse(error, otherwise, "unknown exception", "");
	}
}

void (*note_no_memory)(void);

[[noreturn]] void end_without_memory()
{
	static const char text[] = "error: out of memory within a library that cannot go on\n";
	try {
		if (std::current_exception())
			throw;
	} catch (const std::bad_alloc &) {
		if (note_no_memory)
			note_no_memory();
		_exit(write(STDERR_FILENO, text, sizeof text - 1) < 0 ? 3 : 1);
	} catch (...) {
	}
	std::abort();
}

// LEB128 as Draco writes it; false when it runs out or exceeds 32 bits.
bool varint(const uint8_t *bytes, size_t size, size_t *at, uint32_t *value)
{
	uint64_t v = 0;
	for (int shift = 0; shift < 35; shift += 7) {
		if (*at >= size)
			return false;
		const uint8_t b = bytes[(*at)++];
		v |= static_cast<uint64_t>(b & 0x7f) << shift;
		if (b < 0x80) {
			*value = static_cast<uint32_t>(v);
			return v <= UINT32_MAX;
		}
	}
	return false;
}

struct Bounds {
	uint32_t faces, points;
	int attributes, components;  // components: of all attributes of a point
	bool exceeded;               // out: they were
};

// Checks the counts at the front of the connectivity, which the decoder would trust.
bool connectivity_fits(const draco::DecoderBuffer &buffer, bool edgebreaker, Bounds *bounds)
{
	const uint8_t *bytes = reinterpret_cast<const uint8_t *>(buffer.data_head());
	const size_t size = static_cast<size_t>(buffer.remaining_size());
	size_t at = 0;
	uint32_t first, second, symbols, splits;
	if (!varint(bytes, size, &at, &first) || !varint(bytes, size, &at, &second))
		return false;
	const uint32_t faces = edgebreaker ? second : first, points = edgebreaker ? first : second;
	bounds->exceeded = faces > bounds->faces || points > bounds->points;
	if (bounds->exceeded || !edgebreaker)
		return !bounds->exceeded;
	if (at >= size || bytes[at++] >= bounds->attributes)
		return false;
	return varint(bytes, size, &at, &symbols) && varint(bytes, size, &at, &splits) && symbols <= faces
		&& splits <= symbols;
}

// A decoder that stops where a count exceeds its bound, before allocating for it.
template <class Base, bool kEdgebreaker>
class Bounded : public Base {
 public:
	explicit Bounded(Bounds *bounds) : bounds_(bounds) {}

 protected:
	bool DecodeConnectivity() override
	{
		return connectivity_fits(*this->buffer(), kEdgebreaker, bounds_)
			&& Base::DecodeConnectivity();
	}

	bool CreateAttributesDecoder(int32_t id) override
	{
		return id < bounds_->attributes && Base::CreateAttributesDecoder(id);
	}

	bool DecodeAllAttributes() override
	{
		const draco::PointCloud *cloud = this->point_cloud();
		int components = 0;

		for (int32_t i = 0; i < cloud->num_attributes(); i++)
			components += cloud->attribute(i)->num_components();
		if (cloud->num_attributes() > bounds_->attributes || components > bounds_->components)
			return false;
		bounds_->exceeded = cloud->num_points() > bounds_->points;
		return !bounds_->exceeded && Base::DecodeAllAttributes();
	}

 private:
	Bounds *bounds_;
};

void add_positions(draco::PointCloud *cloud, const int32_t *values, uint32_t rows)
{
	const size_t size = 3 * sizeof(int32_t) * static_cast<size_t>(rows);
	draco::GeometryAttribute attribute;

	attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_INT32, false, 3 * sizeof(int32_t), 0);
	draco::PointAttribute *stored = cloud->attribute(cloud->AddAttribute(attribute, true, rows));
	if (stored->buffer()->data_size() < size)
		throw std::bad_alloc();
	stored->buffer()->Write(0, values, size);
}

enum eco_code give(const draco::EncoderBuffer &buffer, uint8_t **bytes, size_t *size)
{
	*bytes = static_cast<uint8_t *>(std::malloc(buffer.size()));
	if (*bytes == nullptr)
		throw std::bad_alloc();
	std::memcpy(*bytes, buffer.data(), buffer.size());
	*size = buffer.size();
	return ECO_OK;
}

// Decodes a stream; `whole`: no bytes may follow it.
template <class Decoder, class Geometry>
enum eco_code decode(Decoder &&decoder, const uint8_t *bytes, size_t size, bool whole, Geometry *to,
	struct eco_error *error)
{
	draco::DecoderBuffer buffer;

	buffer.Init(reinterpret_cast<const char *>(bytes), size);
	const draco::Status status = decoder.Decode(draco::DecoderOptions(), &buffer, to);
	if (!status.ok())
		return refuse(error, ECO_DAMAGED, "cannot decode", status.error_msg());
	return buffer.remaining_size() == 0 || !whole ? ECO_OK
		: refuse(error, ECO_DAMAGED, "bytes follow the stream", "");
}

// The content of a decoded mesh stream, checked before it is used: Draco does not bound face indices
// itself.
enum eco_code read_faces(const draco::Mesh &mesh, uint32_t faces, int32_t *position, uint32_t *vertex,
struct eco_error *error)
{
	const draco::PointAttribute *a = mesh.num_attributes() == 1 ? mesh.attribute(0) : nullptr;

	if (a == nullptr || a->data_type() != draco::DT_INT32 || a->num_components() != 3)
		return refuse(error, ECO_DAMAGED, "not positions of three integers alone", "");
	if (mesh.num_faces() != faces)
		return refuse(error, ECO_DAMAGED, "faces are missing", "");
	for (uint32_t f = 0; f < faces; f++) {
		const draco::Mesh::Face &face = mesh.face(draco::FaceIndex(f));

		for (int c = 0; c < 3; c++) {
			if (face[c].value() >= mesh.num_points())
				return refuse(error, ECO_DAMAGED, "a face names a point that is not there",
					"");
			const uint32_t value = a->mapped_index(face[c]).value();
			const size_t at = static_cast<size_t>(value) * 12;

			if (value >= a->size() || value >= 3 * faces || at + 12 > a->buffer()->data_size())
				return refuse(error, ECO_DAMAGED,
					"a point names a position that is not there", "");
			std::memcpy(position, a->buffer()->data() + at, 12);
			position += 3;
			*vertex++ = value;
		}
	}
	return ECO_OK;
}

// ---- Meshes of glTF files ----

constexpr int kForeignAttributesMax = 32;
constexpr int kForeignComponentsMax = 64;    // of all attributes of a point

template <class T>
T *array_of(size_t count)
{
	T *array = static_cast<T *>(std::malloc((count + 1) * sizeof(T)));

	if (array == nullptr)
		throw std::bad_alloc();
	return array;
}

enum eco_code take_foreign_faces(const draco::Mesh &mesh, struct eco_draco_mesh *to, struct eco_error *error)
{
	to->index = array_of<uint32_t>(3 * static_cast<size_t>(mesh.num_faces()));
	to->points = mesh.num_points();
	to->faces = mesh.num_faces();
	for (uint32_t f = 0; f < to->faces; f++)
		for (int c = 0; c < 3; c++) {
			const uint32_t point = mesh.face(draco::FaceIndex(f))[c].value();
			if (point >= to->points)
				return refuse(error, ECO_DAMAGED, "a face names a point that is not there",
					"");
			to->index[3 * static_cast<size_t>(f) + c] = point;
		}
	return ECO_OK;
}

enum eco_code take_foreign_values(draco::Mesh *mesh, struct eco_draco_attribute *to, struct eco_error *error)
{
	const int32_t id = mesh->GetAttributeIdByUniqueId(to->id);
	if (id < 0)
		return refuse(error, ECO_DAMAGED, "an attribute is missing", "");
	draco::PointAttribute *a = mesh->attribute(id);
	const uint32_t points = mesh->num_points();
	const size_t stored = a->buffer() == nullptr ? 0 : a->buffer()->data_size();

	a->set_normalized(false);
	to->values = array_of<float>(static_cast<size_t>(points) * to->components);
	for (uint32_t i = 0; i < points; i++) {
		const draco::AttributeValueIndex value = a->is_mapping_identity()
			? draco::AttributeValueIndex(i)
			: i < a->indices_map_size() ? a->mapped_index(draco::PointIndex(i))
			: draco::AttributeValueIndex(UINT32_MAX);

		if (value.value() >= a->size()
				|| (static_cast<size_t>(value.value()) + 1)
				* static_cast<size_t>(a->byte_stride()) > stored)
			return refuse(error, ECO_DAMAGED, "a point names a value that is not there", "");
		if (!a->ConvertValue<float>(value, static_cast<int8_t>(to->components),
				to->values + static_cast<size_t>(i) * to->components))
			return refuse(error, ECO_DAMAGED, "a value that is no number", "");
	}
	return ECO_OK;
}

template <class Base, bool kEdgebreaker>
enum eco_code decode_foreign(const uint8_t *bytes, size_t size, Bounds *bounds,
	struct eco_draco_attribute *attributes, uint32_t count, struct eco_draco_mesh *to, struct eco_error *error)
{
	draco::Mesh mesh;
	struct eco_error why = {};
	enum eco_code code = decode(Bounded<Base, kEdgebreaker>(bounds), bytes, size, false, &mesh,
		&why);

	if (bounds->exceeded)
		return refuse(error, ECO_DAMAGED, "more faces or points than the file says, or than are "
			"possible", "");
	if (code != ECO_OK)
		return eco_fail(error, code, "%s", why.text);
	code = take_foreign_faces(mesh, to, error);
	for (uint32_t i = 0; i < count && code == ECO_OK; i++)
		code = take_foreign_values(&mesh, &attributes[i], error);
	return code;
}

}  // namespace

enum eco_code eco_draco_encode_mesh(const int32_t *position, uint32_t vertices, const uint32_t *index,
	uint32_t faces, uint8_t **bytes, size_t *size, struct eco_error *error)
{
	*bytes = nullptr;
	*size = 0;
	if (vertices == 0 || faces == 0)
		return refuse(error, ECO_BAD_INPUT, "an empty mesh", "");
	return contained(error, ECO_BAD_INPUT, [&]() -> enum eco_code {
		draco::Mesh mesh;
		draco::EncoderBuffer buffer;

		mesh.SetNumFaces(faces);
		for (uint32_t f = 0; f < faces; f++) {
			draco::Mesh::Face face;

			for (int c = 0; c < 3; c++)
				face[c] = index[3 * static_cast<size_t>(f) + c];
			mesh.SetFace(draco::FaceIndex(f), face);
		}
		mesh.set_num_points(vertices);
		add_positions(&mesh, position, vertices);

		draco::ExpertEncoder encoder(mesh);
		encoder.SetSpeedOptions(0, 0);
		encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
		const draco::Status status = encoder.EncodeToBuffer(&buffer);
		if (!status.ok())
			return refuse(error, ECO_BAD_INPUT, "cannot encode mesh", status.error_msg());
		return give(buffer, bytes, size);
	});
}

enum eco_code eco_draco_decode_mesh(const uint8_t *bytes, size_t size, uint32_t faces, int32_t *position,
	uint32_t *vertex, struct eco_error *error)
{
	// as Draco 1.5 writes it: magic, bitstream 2.2, a mesh, edgebreaker, no flags; traversal: 0 standard, 2 valence
	const uint8_t head[11] = { 'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0 };
	Bounds bounds = { faces, faces > UINT32_MAX / 3 ? UINT32_MAX : 3 * faces, 1, 3, false };

	if (size < 12 || std::memcmp(bytes, head, sizeof head) != 0 || (bytes[11] & ~2) != 0)
		return refuse(error, ECO_DAMAGED, "not a mesh", "");
	return contained(error, ECO_DAMAGED, [&]() -> enum eco_code {
		draco::Mesh mesh;
		const enum eco_code code = decode(Bounded<draco::MeshEdgebreakerDecoder, true>(&bounds), bytes, size,
			true, &mesh, error);

		return code != ECO_OK ? code : read_faces(mesh, faces, position, vertex, error);
	});
}

enum eco_code eco_draco_decode_gltf(const uint8_t *bytes, size_t size, uint32_t faces_max,
	uint32_t points_max, struct eco_draco_attribute *attributes, uint32_t attribute_count,
	struct eco_draco_mesh *mesh, struct eco_error *error)
{
	Bounds bounds = { faces_max, points_max, kForeignAttributesMax, kForeignComponentsMax, false };

	*mesh = eco_draco_mesh{};
	for (uint32_t i = 0; i < attribute_count; i++)
		attributes[i].values = nullptr;
	if (size < 11 || std::memcmp(bytes, "DRACO", 5) != 0)
		return refuse(error, ECO_DAMAGED, "not a stream of it", "");
	if (bytes[5] != 2 || bytes[6] != 2 || bytes[7] != 1 || bytes[8] > 1)
		return refuse(error, ECO_UNSUPPORTED, "not a mesh of bitstream version 2.2, which glTF asks "
			"for", "");
	const enum eco_code code = contained(error, ECO_DAMAGED, [&]() -> enum eco_code {
		if (bytes[8] == 1)
			return decode_foreign<draco::MeshEdgebreakerDecoder, true>(bytes, size, &bounds, attributes,
				attribute_count, mesh, error);
		return decode_foreign<draco::MeshSequentialDecoder, false>(bytes, size, &bounds, attributes,
			attribute_count, mesh, error);
	});
	if (code != ECO_OK) {
		std::free(mesh->index);
		*mesh = eco_draco_mesh{};
		for (uint32_t i = 0; i < attribute_count; i++) {
			std::free(attributes[i].values);
			attributes[i].values = nullptr;
		}
	}
	return code;
}

void eco_draco_end_without_memory(void (*note)(void))
{
	note_no_memory = note;
	std::set_terminate(end_without_memory);
}
