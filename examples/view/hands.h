/* What hands.c places, for the buttons of hands_panel.c. Places are in mm, absolute. */
#ifndef LINEAO_VIEW_HANDS_H
#define LINEAO_VIEW_HANDS_H

#include "view.h"

/* --target or --path, with the risk that is set. */
void hands_aim(view *v, const char *flag, const char *value);
void hands_aim_ball(view *v, const double at[3]);
void hands_cut(view *v, const double at[3]);
void hands_look_in_ball(view *v, const double at[3]);
void hands_look_in_circle(view *v, const double at[3]);
/* The lens that is a circle: where (x, y, radius, px of the window; false: there is none), and
 * moved by parts of the picture's width and height, to a radius in heights. */
bool hands_circle(const view *v, double circle[3]);
void hands_move_circle(view *v, double x, double y, double radius);
/* All of these; the last one. */
void hands_take_away(view *v);
void hands_undo(view *v);
/* The sharp ball of a surface; while its radius is dragged there is nothing to take back. */
void hands_focus_here(view *v, const double at[3]);
void hands_focus_at(view *v, const double at[3]);
void hands_unfocus(view *v);

#endif
