# make web: the browser's viewer, build/web/site: the C client as WebAssembly, its page, and a compressed copy of each. ecoserve serves it at /.
# It takes some minutes of processor time once, and a network: Draco's and libwebp's sources are Debian's source packages. So it is no part of
# `make all` or `make test`, whose test_web.sh is skipped without it.
#
# Sources of the client: rooms where all of a room compiles, else its sources. Nothing that encodes, reads packs or imports.

WEB_PACKAGES := emscripten nodejs dpkg-dev brotli libxxhash-dev
W := build/web
# kept apart from native flags: no header of this machine's C library
WEB_FLAGS := -Os -ffp-contract=off -fno-strict-aliasing -ffunction-sections -D_GNU_SOURCE -DXXH_INLINE_ALL -I. -I$(W)/include
WEB_CFLAGS = -std=c11 $(WARN) $(WEB_FLAGS) -I$(W)/src/libwebp/src
WEB_CXXFLAGS = -std=c++17 -fno-rtti $(WEB_FLAGS) -isystem $(W)/src/draco/src
# light is the longest part of a picture: .6 of the time with vectors, which all browsers of the last years have
$(W)/obj/client-min/draw/view_light.o: WEB_FLAGS += -O3 -msimd128
export NODE_PATH := /usr/share/nodejs

WEB_ROOMS := $(wildcard lod/*.c) $(patsubst %,lod/raster/%.c,blocks flip texel) $(wildcard client-min/web/*.c)
WEB_BASE := angle16 array_grow bytes memory range status text
WEB_CHUNK := chunk chunk_columns chunk_decode chunk_ground chunk_mesh chunk_rows chunk_shapes shape
WEB_FORMAT := $(WEB_CHUNK:%=chunk/%) ground_tile heights impostor list model pack_check pack_record plan splat texture \
	view $(patsubst ecofiles/format/%.c,%,$(wildcard ecofiles/format/wire_*.c))
WEB_VIEW := cache ground list query record select store table
WEB_DRAW := gl gpu light mesh picture shader shadow shadow_cast
WEB_SOURCES := $(WEB_BASE:%=ecofiles/base/%.c) $(WEB_FORMAT:%=ecofiles/format/%.c) $(WEB_VIEW:%=client-min/view_%.c) \
	$(WEB_DRAW:%=client-min/draw/view_%.c) $(WEB_ROOMS)

# of Draco what decodes edgebreaker meshes; of libwebp what decodes
WEB_DRACO := $(addprefix core/,data_buffer decoder_buffer draco_types options status bit_utils quantization_utils) \
	$(addprefix attributes/,attribute_octahedron_transform attribute_quantization_transform attribute_transform geometry_attribute \
		point_attribute) \
	$(addprefix compression/bit_coders/,adaptive_rans_bit_decoder direct_bit_decoder rans_bit_decoder symbol_bit_decoder) \
	$(addprefix compression/point_cloud/,point_cloud_decoder) \
	$(addprefix compression/mesh/,mesh_decoder mesh_edgebreaker_decoder mesh_edgebreaker_decoder_impl) \
	$(addprefix compression/,draco_compression_options entropy/symbol_decoding) \
	$(addprefix compression/attributes/,attributes_decoder sequential_attribute_decoder \
		sequential_attribute_decoders_controller sequential_integer_attribute_decoder sequential_normal_attribute_decoder \
		sequential_quantization_attribute_decoder) \
	$(addprefix mesh/,corner_table mesh mesh_attribute_corner_table) point_cloud/point_cloud \
	$(addprefix metadata/,geometry_metadata metadata metadata_decoder)
WEB_WEBP := $(addprefix dec/,alpha_dec buffer_dec frame_dec idec_dec io_dec quant_dec tree_dec vp8_dec vp8l_dec webp_dec) \
	$(addprefix dsp/,alpha_processing cpu dec dec_clip_tables filters lossless rescaler upsampling yuv) \
	$(addprefix utils/,bit_reader_utils bit_writer_utils color_cache_utils filters_utils huffman_encode_utils huffman_utils \
		quant_levels_dec_utils quant_levels_utils random_utils rescaler_utils thread_utils utils)
WEB_OBJECTS := $(WEB_SOURCES:%.c=$(W)/obj/%.o) $(W)/obj/ecofiles/format/chunk/draco_shim.o $(WEB_DRACO:%=$(W)/obj/draco/%.o) \
	$(WEB_WEBP:%=$(W)/obj/libwebp/%.o)

# the planner of published scenes: server/publish/README.md
PLANNER_LACKS := model $(patsubst %,chunk/%,chunk_ground chunk_mesh chunk_shapes shape)
PLANNER_SOURCES := $(wildcard server/publish/web/*.c) server/publish/index.c server/publish/index_columns.c $(wildcard server/stream*.c) server/describe.c server/plants.c \
	$(patsubst %,server/request/%.c,json query target) $(wildcard lod/plan/*.c lod/seen/*.c lod/*.c) $(WEB_BASE:%=ecofiles/base/%.c) \
	$(patsubst %,ecofiles/format/%.c,$(filter-out $(PLANNER_LACKS),$(WEB_FORMAT)) inventory)
PLANNER_OBJECTS := $(PLANNER_SOURCES:%.c=$(W)/obj/%.o)
# -Oz, as it is fetched beside a first picture, but for what plans; uint64_t is no long there
PLANNER_FLAGS := -DNDEBUG -Wno-format -Wno-missing-field-initializers -Wno-unused-parameter -Wno-unused-variable -Wno-unused-but-set-variable
$(W)/obj/server/%.o: WEB_FLAGS += -Oz $(PLANNER_FLAGS)
$(W)/obj/lod/plan/%.o $(W)/obj/lod/seen/%.o: WEB_FLAGS += -O2 -msimd128 -mbulk-memory $(PLANNER_FLAGS)

# every function of web_client.h, of planner.h
exports_of = $(shell grep -v '^ \*' $(1) | grep -oE '\b$(2)_[a-z_]+\b' | grep -v '_present_' | sort -u)
WEB_EXPORTS := $(call exports_of,client-min/web/web_client.h,web)
PLANNER_EXPORTS := $(call exports_of,server/publish/web/planner.h,planner)
space := $(subst ,, )
comma_join = $(subst $(space),$(comma),$(strip $(1)))

WEB_PAGE := $(patsubst client-min/web/%,$(W)/site/%,$(filter-out %.md %.mk %.c %.h %.sh %.glsl %/examples %/npm,$(wildcard client-min/web/*)))
PLANNER_PAGE := $(patsubst server/publish/web/%,$(W)/site/%,$(wildcard server/publish/web/*.mjs))
WEB_INDEX := $(W)/site/index.html
WEB_MODULES := eco_client eco_planner
WEB_FILES := $(foreach module,$(WEB_MODULES),$(W)/site/$(module).mjs $(W)/site/$(module).wasm) $(filter-out $(WEB_INDEX),$(WEB_PAGE)) \
	$(PLANNER_PAGE)
WEB_SITE := $(WEB_FILES) $(WEB_INDEX)

.PHONY: web deps-web web-site
# what `make web` installs, and the browser that tests draw with
deps-web: deps
	@tests/packages.sh $(WEB_PACKAGES) chromium
web: deps
	@tests/packages.sh $(WEB_PACKAGES)
	@$(MAKE) --no-print-directory $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$$(nproc)) web-site
	@echo "$(W)/site: $$(cat $(W)/site/*.gz | wc -c) bytes by gzip, $$(cat $(W)/site/*.br | wc -c) by brotli"

web-site: $(WEB_SITE:%=%.gz) $(WEB_SITE:%=%.br) $(W)/site/version

$(W)/src/.done: client-min/web/sources.sh
	sh $< $(W)/src draco libwebp
# Draco's own build writes this file; neither transcoding nor old bitstreams are wanted.
$(W)/include/draco/draco_features.h: $(W)/src/.done
	@mkdir -p $(@D)
	printf '#define DRACO_%s_SUPPORTED\n' POINT_CLOUD_COMPRESSION MESH_COMPRESSION NORMAL_ENCODING STANDARD_EDGEBREAKER \
		PREDICTIVE_EDGEBREAKER ATTRIBUTE_INDICES_DEDUPLICATION ATTRIBUTE_VALUES_DEDUPLICATION >$@
	cp /usr/include/xxhash.h /usr/include/xxh3.h /usr/include/jansson.h /usr/include/jansson_config.h $(W)/include/
	mkdir -p $(W)/include/epoxy && echo '#include <GLES3/gl3.h>' >$(W)/include/epoxy/gl.h

$(WEB_OBJECTS) $(PLANNER_OBJECTS): | $(SHADERS:%=build/text/%)

$(WEB_OBJECTS) $(PLANNER_OBJECTS): | $(W)/include/draco/draco_features.h
$(W)/obj/draco/%.o: | $(W)/include/draco/draco_features.h
	$(call say,em++,$@)
	@mkdir -p $(@D)
	$(Q)em++ $(WEB_CXXFLAGS) -c -o $@ $(W)/src/draco/src/draco/$*.cc
$(W)/obj/libwebp/%.o: | $(W)/include/draco/draco_features.h
	$(call say,emcc,$@)
	@mkdir -p $(@D)
	$(Q)emcc $(WEB_FLAGS) -I$(W)/src/libwebp -c -o $@ $(W)/src/libwebp/src/$*.c
$(W)/obj/%.o: %.c
	$(call say,emcc,$@)
	@mkdir -p $(@D)
	$(Q)emcc $(WEB_CFLAGS) -MMD -MP -c -o $@ $<
$(W)/obj/%.o: %.cpp
	$(call say,em++,$@)
	@mkdir -p $(@D)
	$(Q)em++ $(WEB_CXXFLAGS) -MMD -MP -c -o $@ $<
-include $(shell find $(W)/obj -name '*.d' 2>/dev/null)

# 2 GiB is what a page may grow to; what does not fit goes (view_cache.h)
WEB_LINK := -sMODULARIZE=1 -sEXPORT_ES6=1 -sENVIRONMENT=web,worker -sFILESYSTEM=0 -sALLOW_MEMORY_GROWTH=1 -sASSERTIONS=0
$(W)/eco_client.mjs: $(WEB_OBJECTS) client-min/web/web_client.h
	$(call say,emcc,$@)
	$(Q)emcc -Os -o $@ $(WEB_OBJECTS) $(WEB_LINK) -sUSE_WEBGL2=1 -sMIN_WEBGL_VERSION=2 -sMAX_WEBGL_VERSION=2 \
		-sEXPORTED_FUNCTIONS=_malloc,_free,$(call comma_join,$(WEB_EXPORTS:%=_%)) -sEXPORTED_RUNTIME_METHODS=UTF8ToString,GL
$(W)/eco_planner.mjs: $(PLANNER_OBJECTS) server/publish/web/planner.h
	$(call say,emcc,$@)
	$(Q)emcc -Oz -o $@ $(PLANNER_OBJECTS) $(WEB_LINK) \
		-sEXPORTED_FUNCTIONS=_malloc,_free,$(call comma_join,$(PLANNER_EXPORTS:%=_%)) -sEXPORTED_RUNTIME_METHODS=UTF8ToString
define web_module
$(W)/site/$(1).mjs $(W)/site/$(1).wasm: $(W)/site/%: $(W)/$(1).mjs
	@mkdir -p $$(@D)
	@cp $(W)/$$* $$@
endef
$(foreach module,$(WEB_MODULES),$(eval $(call web_module,$(module))))
$(PLANNER_PAGE): $(W)/site/%: server/publish/web/%
	@mkdir -p $(@D)
	@cp $< $@
$(filter-out $(WEB_INDEX),$(WEB_PAGE)): $(W)/site/%: client-min/web/%
	@mkdir -p $(@D)
	@cp $< $@
# Addresses name what is there, so that browsers need not ask whether it has changed: viewer/VERSION/NAME. They are relative to the page,
# which a proxy may have below a path.
$(W)/site/version: $(WEB_FILES) client-min/web/index.html
	@cat $(sort $^) | sha256sum | cut -c 1-16 >$@
$(WEB_INDEX): client-min/web/index.html $(W)/site/version
	@sed "s|\"viewer/|&$$(cat $(W)/site/version)/|" $< >$@
$(W)/site/%.gz: $(W)/site/%
	@gzip -9 -n -c $< >$@
$(W)/site/%.br: $(W)/site/%
	@brotli -q 11 -c $< >$@

# The layer for people who build pages with npm: `npm pack ./build/web/package`, or name the folder as a dependency.
PACKAGE_FILES := $(filter eco_%,$(notdir $(WEB_FILES)))
.PHONY: web-package
web-package: web-site
	@rm -rf $(W)/package && mkdir -p $(W)/package
	@cp $(PACKAGE_FILES:%=$(W)/site/%) client-min/web/npm/README.md LICENSE $(W)/package
	@sed 's/"version": "[^"]*"/"version": "$(VERSION).0"/' client-min/web/npm/package.json >$(W)/package/package.json
	@echo "$(W)/package: npm pack ./$(W)/package"

# Pages of other origins that have a scene as a layer: build/web/examples, for any web server, beside what they draw with, which npm fetches
# (other packages of nodejs than Debian's bring it, and Debian's own then cannot be installed).
WEB_EXAMPLES := $(W)/examples
EXAMPLE_PARTS := maplibre-gl/dist/maplibre-gl.mjs maplibre-gl/dist/maplibre-gl-worker.mjs maplibre-gl/dist/maplibre-gl.css \
	three/build/three.module.js three/build/three.core.js three/examples/jsm/controls/OrbitControls.js
EXAMPLE_PAGES := $(patsubst client-min/web/examples/%,$(WEB_EXAMPLES)/%,$(wildcard client-min/web/examples/*.html client-min/web/examples/example.*))
.PHONY: web-examples examples-site
web-examples: web
	@command -v npm >/dev/null || tests/packages.sh npm
	@$(MAKE) --no-print-directory examples-site
	@echo "$(WEB_EXAMPLES): serve it, say by python3 -m http.server 8000 -d $(WEB_EXAMPLES), and the scene by $(B)/ecoserve --cors http://127.0.0.1:8000 MY.eco;" \
		"http://127.0.0.1:8000/map.html?scene=http://127.0.0.1:8080/v1/scenes/MY"
examples-site: $(EXAMPLE_PAGES) $(WEB_EXAMPLES)/.parts
$(EXAMPLE_PAGES): $(WEB_EXAMPLES)/%: client-min/web/examples/%
	@mkdir -p $(@D)
	@cp $< $@
$(W)/npm/.done: client-min/web/examples/package.json client-min/web/examples/package-lock.json
	@mkdir -p $(@D)
	@cp $^ $(@D)
	npm ci --prefix $(@D) --ignore-scripts --no-audit --no-fund
	touch $@
$(WEB_EXAMPLES)/.parts: $(W)/npm/.done
	@mkdir -p $(@D)
	@cp $(EXAMPLE_PARTS:%=$(W)/npm/node_modules/%) $(@D)
	touch $@

# Other people's viewers and checkers of 3D Tiles, for tests/ecopack/test_tiles.sh.
.PHONY: tiles-viewers
tiles-viewers:
	@tests/packages.sh nodejs chromium && { command -v npm >/dev/null || tests/packages.sh npm; }
	@mkdir -p build/tiles-viewers
	cp tests/ecopack/tiles/package.json tests/ecopack/tiles/package-lock.json build/tiles-viewers
	npm ci --prefix build/tiles-viewers --ignore-scripts --no-audit --no-fund
