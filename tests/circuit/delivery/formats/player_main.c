/* Runs the exported player on a simulated plate through a scenario (pairs NAME VALUE on stdin), and prints what became
   of it by the true time in s, which the board's clock may not tell. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "double_dip.h"
#include "thermicon_player.h"

enum { DT, TURNS, START, TICK, STAND, BACK, BACK_US, LATE, LATE_US, MUTE, BAD, KIND, WHICH, ABORT, BEGIN, SWAPPED, DRIFT,
       DRIFT_MK, STEP_MK, SENSORS, OLD, COUNT };
static const char *const NAMES[COUNT] = {
    "dt_us", "turns", "start_us", "tick_us", "stand_at", "back_at", "back_us", "late_at", "late_us", "mute_at", "bad_at",
    "kind", "which", "abort_at", "begin_at", "swapped", "drift_at", "drift_mK", "step_mK", "sensors", "old"};
static double of[COUNT] = {10000, 6000, 0, 1, 1e9, 1e9, 0, 1e9, 0, 1e9, 1e9, 0, 3, 1e9, 1e9, 0, 1e9, 0, 0, 3, 0};

/* A plate of one heat capacity: a command above 0 cools it, and the room and a standing flow hold it near 32. */
static double plate_C = 32.0, out, true_us;
static float noise = 0.002f, last_C[2];
static long turn;

static int measured(int sensor, float *display_C) {
    int bad = turn >= of[BAD] && ((int)of[WHICH] >> sensor & 1), kind = (int)of[KIND];
    float now = (float)plate_C + (noise = -noise);
    if (of[STEP_MK] > 0) now = (float)(round(plate_C * 1e3 / of[STEP_MK]) * of[STEP_MK] * 1e-3);
    if (bad && kind == 1) return 0;
    if (bad && kind == 2) now = last_C[sensor];
    if (bad && kind == 3) now = NAN;
    if (bad && kind == 4) now += 30.0f;
    *display_C = last_C[sensor] = now;
    return 1;
}
static int measure(void *context, float *display_C) { return (void)context, measured(0, display_C); }
static int measure_second(void *context, float *display_C) { return (void)context, measured(1, display_C); }
static void put_out(void *context, float command) { (void)context, out = command; }

static uint32_t now_us(void *context) {
    static double stood;
    double now = of[START] + true_us - (turn >= of[BACK] ? of[BACK_US] : 0.0);
    (void)context;
    if (turn < of[STAND]) stood = now;
    return (uint32_t)(uint64_t)(floor(stood / of[TICK]) * of[TICK]);
}

static int is_drive(const thermicon_player *player, double since_us) {
    double shown = THERMICON_CLOSED_LOOP ? (double)player->goal : out;
    long place = (long)(since_us * 1e3 / player->icon.period_ns), k;
    for (k = place - 2; k <= place + 2; k++) {
        long at = k < 0 || k >= (long)player->icon.count ? 0 : k;
        if (fabs(shown - (player->icon.offset + player->icon.step * player->icon.wave[at])) < 1e-6) return 1;
    }
    return 0;
}

int main(void) {
    thermicon_board board = {measure, put_out, NULL, 3.0f, 2.0f, 0.02f, -1.5f, 1.5f, now_us, measure_second};
    thermicon_player player;
    thermicon_icon icon = THERMICON_ICON(double_dip);
    char name[32];
    double value, coldest = 99, largest = 0, free_us = 0, begun_us = 0, least_s = 1e9, pause_s = 1e9, began = -1, ended = -1;
    double stopped = -1, wrong_s = 0;
    int k, begun, first, plays = 0, was;
    while (scanf("%31s %lf", name, &value) == 2)
        for (k = 0; k < COUNT; k++)
            if (!strcmp(name, NAMES[k])) of[k] = value;
    if (!((int)of[SENSORS] & 1)) board.measure = NULL;
    if (!((int)of[SENSORS] & 2)) board.measure_second = NULL;
    if (of[OLD] > 0) board.now_us = NULL;
    begun = thermicon_begin(&player, &board, icon);
    first = thermicon_play(&player, icon);
    for (turn = 0; turn < of[TURNS]; turn++) {
        double dt_us = of[DT] + (turn == of[LATE] ? of[LATE_US] : 0.0);
        true_us += dt_us;
        plate_C += 1e-6 * dt_us * ((of[SWAPPED] > 0 ? GAIN : -GAIN) * out + 0.2 * (32.0 + SHIFT - plate_C));
        if (turn >= of[DRIFT]) plate_C += 1e-3 * of[DRIFT_MK];
        if (turn < of[MUTE]) thermicon_feed(&player);
        if (turn == of[ABORT]) thermicon_abort(&player);
        if (turn == of[BEGIN]) {
            begun = thermicon_begin(&player, &board, icon);
            free_us = begun_us = true_us, plays = 0, stopped = -1;
        }
        was = player.state;
        thermicon_step(&player);
        if (was == THERMICON_PLAYING && player.state == THERMICON_PLAYING && !is_drive(&player, true_us - free_us))
            wrong_s += 1e-6 * dt_us;
        if (was == THERMICON_PLAYING && player.state != THERMICON_PLAYING) {
            if (ended < 0) ended = 1e-6 * true_us;
            free_us = true_us;
        }
        if (player.state == THERMICON_STOPPED && stopped < 0) stopped = 1e-6 * true_us;
        if (player.state == THERMICON_PLAYING && plate_C < coldest) coldest = plate_C;
        if (player.state == THERMICON_PLAYING && fabs(out) > largest) largest = fabs(out);
        if (thermicon_play(&player, icon) == THERMICON_OK) {
            double waited = 1e-6 * (true_us - (plays ? free_us : begun_us)), *least = plays ? &pause_s : &least_s;
            if (waited < *least) *least = waited;
            if (began < 0) began = 1e-6 * true_us;
            free_us = true_us, plays++;
        }
    }
    printf("begun %d first %d began %f ended %f plays %d waited %f paused %f ", begun, first, began, ended, plays, least_s,
           pause_s);
    printf("state %d fault %d out %f stopped %f wrong %f ", (int)player.state, (int)player.fault, out, stopped, wrong_s);
    printf("coldest %f largest %f\n", coldest, largest);
    return 0;
}
