#include "text.h"

#include <stdlib.h>
#include <string.h>

bool text_draw(picture *p, int64_t x, int64_t y, text_anchor anchor, const char *text,
               const text_style *style) {
    text_mask mask;
    if (*text == '\0')
        return true;
    if (!text_mask_make(text, style, &mask))
        return false;
    int64_t width = text_width(text, style);
    int64_t left = x - (anchor == TEXT_LEFT ? 0 : anchor == TEXT_CENTER ? width / 2 : width);
    for (uint32_t i = 0; i < mask.width * mask.height; i++) {
        int64_t u = left - mask.margin + i % mask.width, v = y - mask.margin + i / mask.width;
        if (mask.outline[i])
            picture_blend(p, u, v, style->outline, mask.outline[i] / 255.0);
        if (mask.letters[i])
            picture_blend(p, u, v, style->ink, mask.letters[i] / 255.0);
    }
    free(mask.letters);
    free(mask.outline);
    return true;
}

/* Width of the first bytes of a text; too long for a line: wide. */
static uint32_t width_of(const char *text, size_t bytes, const text_style *style) {
    char part[512];
    if (bytes >= sizeof part)
        return UINT32_MAX;
    memcpy(part, text, bytes);
    part[bytes] = '\0';
    return text_width(part, style);
}

uint32_t text_fit(const char *text, uint32_t width, const text_style *style) {
    size_t fits = 0, words = 0;
    for (size_t i = 1; text[0] && text[i - 1]; i++) {
        if (((unsigned char)text[i] & 0xC0) == 0x80)
            continue; /* inside a UTF-8 character */
        if (fits > 0 && width_of(text, i, style) > width)
            return (uint32_t)(words ? words : fits);
        fits = i;
        words = text[i] == ' ' || text[i] == '\0' ? i : words;
    }
    return (uint32_t)fits;
}
