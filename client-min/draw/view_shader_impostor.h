/* The shaders of impostors, parts of the texts in view_shader.c. */
#ifndef VIEW_SHADER_IMPOSTOR_H
#define VIEW_SHADER_IMPOSTOR_H

extern const char view_shader_impostor_vertex[], view_shader_impostor_fragment[];

#endif
