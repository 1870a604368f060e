/* thermicon_player.h: plays exported icons on a microcontroller. Written by thermicon; never played on a device.

   Call thermicon_step() at a steady rate, at least every THERMICON_REACT_S. It puts out zero, for good, when the
   measured temperature leaves THERMICON_LOW_C ... THERMICON_HIGH_C, the sensor is lost or frozen, the host has not
   called thermicon_feed() for THERMICON_WATCHDOG_S, the loop is late, or thermicon_abort() was called; only
   thermicon_begin() leaves a fault. It is no replacement for a cut-off that works without software.

       thermicon_player player;
       thermicon_begin(&player, &board, THERMICON_ICON(cooling_step));   tests the polarity, then holds the rest
       thermicon_play(&player, THERMICON_ICON(cooling_step));            THERMICON_OK, or why not yet

   What the gate of safety says of these drives:
@VERDICTS@
*/
#ifndef THERMICON_PLAYER_H
#define THERMICON_PLAYER_H

#include <stddef.h>
#include <stdint.h>
#ifdef __AVR__
#include <avr/pgmspace.h>
#define THERMICON_CODE(wave, k) ((int16_t)pgm_read_word(&(wave)[k]))
#else
#define THERMICON_CODE(wave, k) ((wave)[k])
#endif

#define THERMICON_CLOSED_LOOP @CLOSED_LOOP@ /* 1: codes are set-points of the loop below; 0: codes are put out */
#define THERMICON_WATCHDOG_S @WATCHDOG_S@
#define THERMICON_LOW_C @LOW_C@
#define THERMICON_HIGH_C @HIGH_C@
#define THERMICON_REACT_S @REACT_S@
#define THERMICON_REST_S @REST_S@
#define THERMICON_PAUSE_S @PAUSE_S@
#define THERMICON_TEST_POLARITY @TEST_POLARITY@
#define THERMICON_TEST_COMMAND @TEST_COMMAND@ /* @TEST_UNIT@; cools */
#define THERMICON_TEST_S @TEST_S@
#define THERMICON_TEST_FALL_K @TEST_FALL_K@

/* With set-points, the loop that was judged (otherwise not used): gains in A/K, A/(K s) and A s/K, and current limits,
   which the output never leaves. */
#define THERMICON_KP @KP@
#define THERMICON_KI @KI@
#define THERMICON_KD @KD@
#define THERMICON_LOWEST_A @LOWEST_A@
#define THERMICON_HIGHEST_A @HIGHEST_A@

/* A thermistor that is open or shorted reads far outside these. */
#ifndef THERMICON_SENSOR_LOW_C
#define THERMICON_SENSOR_LOW_C (-20.0f)
#define THERMICON_SENSOR_HIGH_C 120.0f
#endif
/* The last digit of a live reading moves within seconds; raise this for a coarse sensor. */
#ifndef THERMICON_FROZEN_S
#define THERMICON_FROZEN_S 5.0f
#endif
/* A set-point that has moved so far has moved the display too. */
#ifndef THERMICON_FROZEN_K
#define THERMICON_FROZEN_K 2.0f
#endif

typedef enum { THERMICON_TESTING, THERMICON_RESTING, THERMICON_PLAYING, THERMICON_STOPPED } thermicon_state;

typedef enum {
    THERMICON_NO_FAULT,
    THERMICON_ABORTED,
    THERMICON_HOST_SILENT,
    THERMICON_LOOP_LATE,
    THERMICON_SENSOR_LOST,
    THERMICON_SENSOR_FROZEN,
    THERMICON_TOO_COLD,
    THERMICON_TOO_WARM,
    THERMICON_POLARITY_SWAPPED
} thermicon_fault;

typedef enum {
    THERMICON_OK,
    THERMICON_NO_SENSOR,
    THERMICON_NOT_RESTED,
    THERMICON_TOO_SOON,
    THERMICON_BUSY,
    THERMICON_HAS_STOPPED
} thermicon_answer;

typedef struct {
    const int16_t *wave;
    uint32_t count, period_ns;
    float offset, step; /* command, or temperature in degrees C, = offset + step * code */
} thermicon_icon;

typedef struct {
    /* Measured temperature of the display in degrees C; returns 0 where there is none. NULL: no sensor, which leaves
       an open loop without cut-off and polarity test, and is refused for a closed one. */
    int (*measure)(void *context, float *display_C);
    void (*put_out)(void *context, float command); /* @OUTPUT_UNIT@; above 0 cools, 0 is off */
    void *context;
    /* PI(D) loop on the measured temperature, for set-points only: A/K, A/(K s), A s/K, least and most output in A.
       Use those that were judged: THERMICON_KP, THERMICON_KI, THERMICON_KD, THERMICON_LOWEST_A, THERMICON_HIGHEST_A. */
    float kp, ki, kd, lowest, highest;
} thermicon_board;

typedef struct {
    const thermicon_board *board;
    thermicon_icon icon;
    thermicon_state state;
    thermicon_fault fault;
    float in_state_s, silent_s, same_s;
    float measured_C, before_C, test_from_C, goal, goal_when_changed, integral;
    uint32_t place;
    uint64_t time_ns;
    uint8_t has_reading, has_goal, has_played;
} thermicon_player;

static inline thermicon_icon thermicon_icon_of(const int16_t *wave, uint32_t count, uint32_t period_ns, float offset,
                                               float step) {
    thermicon_icon icon;
    icon.wave = wave;
    icon.count = count;
    icon.period_ns = period_ns;
    icon.offset = offset;
    icon.step = step;
    return icon;
}

#define THERMICON_ICON(name) \
    thermicon_icon_of(name##_wave, name##_count, name##_period_ns, name##_offset, name##_step)

static inline void thermicon_enter(thermicon_player *player, thermicon_state state) {
    player->state = state;
    player->in_state_s = 0.0f;
}

static inline void thermicon_stop(thermicon_player *player, thermicon_fault fault) {
    player->board->put_out(player->board->context, 0.0f);
    if (player->state != THERMICON_STOPPED) player->fault = fault;
    player->state = THERMICON_STOPPED;
}

/* Zero output at once, for good. */
static inline void thermicon_abort(thermicon_player *player) { thermicon_stop(player, THERMICON_ABORTED); }

/* The host is alive; call it from what the host sends, never from a timer of this board. */
static inline void thermicon_feed(thermicon_player *player) { player->silent_s = 0.0f; }

/* Begin at zero output: the polarity is tested, then the rest of the icon is held. */
static inline thermicon_answer thermicon_begin(thermicon_player *player, const thermicon_board *board,
                                               thermicon_icon icon) {
    player->board = board;
    player->icon = icon;
    player->fault = THERMICON_NO_FAULT;
    player->silent_s = player->same_s = player->integral = 0.0f;
    player->measured_C = player->before_C = player->test_from_C = 0.0f;
    player->goal = player->goal_when_changed = 0.0f;
    player->place = 0;
    player->time_ns = 0;
    player->has_reading = player->has_goal = player->has_played = 0;
    thermicon_enter(player, THERMICON_TEST_POLARITY && board->measure ? THERMICON_TESTING : THERMICON_RESTING);
    if (THERMICON_CLOSED_LOOP && !board->measure) {
        thermicon_stop(player, THERMICON_SENSOR_LOST);
        return THERMICON_NO_SENSOR;
    }
    board->put_out(board->context, 0.0f);
    return THERMICON_OK;
}

/* Play an icon, or say why not yet: the rest was not held long enough, or the pause after the last play was not. */
static inline thermicon_answer thermicon_play(thermicon_player *player, thermicon_icon icon) {
    if (player->state == THERMICON_STOPPED) return THERMICON_HAS_STOPPED;
    if (player->state == THERMICON_PLAYING) return THERMICON_BUSY;
    if (player->state == THERMICON_TESTING) return THERMICON_NOT_RESTED;
    if (!player->has_played && player->in_state_s < THERMICON_REST_S) return THERMICON_NOT_RESTED;
    if (player->has_played && player->in_state_s < THERMICON_PAUSE_S) return THERMICON_TOO_SOON;
    player->icon = icon;
    player->place = 0;
    player->time_ns = 0;
    player->has_played = 1;
    thermicon_enter(player, THERMICON_PLAYING);
    return THERMICON_OK;
}

/* Reads the sensor and checks it; 0 where the player has stopped over it. */
static inline int thermicon_look(thermicon_player *player, float elapsed_s) {
    float now = 0.0f, moved;
    if (!player->board->measure) return 1;
    if (!player->board->measure(player->board->context, &now) ||
        !(now > THERMICON_SENSOR_LOW_C && now < THERMICON_SENSOR_HIGH_C)) { /* not a number fails too */
        thermicon_stop(player, THERMICON_SENSOR_LOST);
        return 0;
    }
    player->before_C = player->has_reading ? player->measured_C : now;
    if (!player->has_reading || now < player->measured_C || now > player->measured_C) {
        player->same_s = 0.0f;
        player->goal_when_changed = player->goal;
    } else {
        player->same_s += elapsed_s;
    }
    player->measured_C = now;
    player->has_reading = 1;
    if (now < THERMICON_LOW_C || now > THERMICON_HIGH_C) {
        thermicon_stop(player, now < THERMICON_LOW_C ? THERMICON_TOO_COLD : THERMICON_TOO_WARM);
        return 0;
    }
    moved = player->goal - player->goal_when_changed;
    if (player->same_s > THERMICON_FROZEN_S ||
        (THERMICON_CLOSED_LOOP && player->has_played &&
         (moved > THERMICON_FROZEN_K || moved < -THERMICON_FROZEN_K))) {
        thermicon_stop(player, THERMICON_SENSOR_FROZEN);
        return 0;
    }
    return 1;
}

/* The loop: too warm asks for current that cools. The integral stops where the output is at its limit. */
static inline float thermicon_regulate(thermicon_player *player, float elapsed_s) {
    const thermicon_board *board = player->board;
    float error = player->measured_C - player->goal;
    float rate = elapsed_s > 0.0f ? (player->measured_C - player->before_C) / elapsed_s : 0.0f;
    float sum = player->integral + board->ki * error * elapsed_s;
    float out = board->kp * error + sum + board->kd * rate;
    float highest = board->highest < THERMICON_HIGHEST_A ? board->highest : THERMICON_HIGHEST_A;
    float lowest = board->lowest > THERMICON_LOWEST_A ? board->lowest : THERMICON_LOWEST_A;
    if (out > highest) return highest;
    if (out < lowest) return lowest;
    player->integral = sum;
    return out;
}

/* One turn, `elapsed_s` after the last; returns the state. */
static inline thermicon_state thermicon_step(thermicon_player *player, float elapsed_s) {
    const thermicon_board *board = player->board;
    if (player->state == THERMICON_STOPPED) {
        board->put_out(board->context, 0.0f);
        return player->state;
    }
    player->silent_s += elapsed_s;
    player->in_state_s += elapsed_s;
    if (player->silent_s > THERMICON_WATCHDOG_S) {
        thermicon_stop(player, THERMICON_HOST_SILENT);
        return player->state;
    }
    if (elapsed_s > THERMICON_REACT_S) {
        thermicon_stop(player, THERMICON_LOOP_LATE);
        return player->state;
    }
    if (!thermicon_look(player, elapsed_s)) return player->state;
    if (player->state == THERMICON_TESTING) {
        if (!player->has_goal) {
            player->test_from_C = player->measured_C;
            player->has_goal = 1;
            player->in_state_s = 0.0f;
        }
        if (player->in_state_s < THERMICON_TEST_S) {
            board->put_out(board->context, THERMICON_TEST_COMMAND);
            return player->state;
        }
        if (player->test_from_C - player->measured_C < THERMICON_TEST_FALL_K) {
            thermicon_stop(player, THERMICON_POLARITY_SWAPPED);
            return player->state;
        }
        thermicon_enter(player, THERMICON_RESTING);
    }
    if (player->state == THERMICON_PLAYING) {
        player->time_ns += (uint64_t)(elapsed_s * 1e9f);
        player->place = (uint32_t)(player->time_ns / player->icon.period_ns);
        if (player->place >= player->icon.count - 1) thermicon_enter(player, THERMICON_RESTING);
    }
    player->goal = player->icon.offset +
                   player->icon.step * (float)THERMICON_CODE(player->icon.wave,
                                                             player->state == THERMICON_PLAYING ? player->place : 0);
    board->put_out(board->context, THERMICON_CLOSED_LOOP ? thermicon_regulate(player, elapsed_s) : player->goal);
    return player->state;
}

#endif
