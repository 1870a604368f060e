/* Runs the exported player on a simulated plate through one story, and prints what became of it. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "double_dip.h"
#include "thermicon_player.h"

/* A plate of one heat capacity: a command above 0 cools it, and the room and a standing flow hold it near 32. */
typedef struct { float temperature_C, out, sign, gain, noise; int lost, frozen; float stuck_C; } plate;

static int measure(void *context, float *display_C) {
    plate *p = context;
    p->noise = -p->noise;
    if (p->lost) return 0;
    *display_C = p->frozen ? p->stuck_C : p->temperature_C + p->noise;
    return 1;
}

static void put_out(void *context, float command) { ((plate *)context)->out = command; }

static void go_on(plate *p, float dt) {
    p->temperature_C += dt * (-p->sign * p->gain * p->out + 0.2f * (32.0f + SHIFT - p->temperature_C));
}

int main(int argc, char **argv) {
    const char *story = argc > 1 ? argv[1] : "normal";
    plate p = {32.0f, 0.0f, 1.0f, GAIN, 0.002f, 0, 0, 0.0f};
    thermicon_board board = {measure, put_out, &p, 3.0f, 2.0f, 0.02f, -1.5f, 1.5f};
    thermicon_player player;
    thermicon_icon icon = THERMICON_ICON(double_dip);
    float dt = 0.01f, coldest = 99.0f, first_try = -1.0f, plays = 0.0f, largest_out = 0.0f;
    long turn, plays_began = -1, ended = -1;
    int answer = -1, early = -1, begun;
    if (!strcmp(story, "swapped")) p.sign = -1.0f;
    if (!strcmp(story, "no-sensor")) board.measure = NULL;
    begun = thermicon_begin(&player, &board, icon);
    first_try = (float)thermicon_play(&player, icon);
    for (turn = 0; turn < 6000; turn++) {
        if (strcmp(story, "hang") || turn < 3600) thermicon_feed(&player);
        if (!strcmp(story, "lost") && turn == 3600) p.lost = 1;
        if (!strcmp(story, "frozen") && turn == 3600) { p.frozen = 1; p.stuck_C = p.temperature_C; }
        if (!strcmp(story, "abort") && turn == 3600) thermicon_abort(&player);
        if (!strcmp(story, "runaway") && turn >= 3600) p.temperature_C -= 0.2f;
        if (!strcmp(story, "hot") && turn >= 3600) p.temperature_C += 0.2f;
        thermicon_step(&player, !strcmp(story, "late") && turn == 3600 ? 0.3f : dt);
        go_on(&p, dt);
        if (player.state == THERMICON_PLAYING && p.temperature_C < coldest) coldest = p.temperature_C;
        if (player.state == THERMICON_PLAYING && fabsf(p.out) > largest_out) largest_out = fabsf(p.out);
        if (plays_began < 0 && thermicon_play(&player, icon) == THERMICON_OK) { plays_began = turn; plays += 1; }
        if (plays_began >= 0 && ended < 0 && player.state == THERMICON_RESTING) {
            ended = turn;
            early = thermicon_play(&player, icon);
        }
        if (ended >= 0 && turn == ended + 1990) answer = thermicon_play(&player, icon);
        if (ended >= 0 && turn == ended + 2010 && thermicon_play(&player, icon) == THERMICON_OK) plays += 1;
    }
    printf("begun %d first %d began %ld ended %ld ", begun, (int)first_try, plays_began, ended);
    printf("early %d again %d plays %d ", early, answer, (int)plays);
    printf("state %d fault %d out %.3f ", (int)player.state, (int)player.fault, (double)p.out);
    printf("coldest %.2f ", (double)coldest);
    printf("largest %.3f\n", (double)largest_out);
    return 0;
}
