/* thermicon_serial.h: lets `thermicon play --device board` play on a microcontroller. Never tried on a device.

   Lines of text at 115,200 baud, each with * and the CRC-16 (XMODEM) of what stands before it in four hexadecimal digits.
   Numbers are whole: ms, thousandths of degrees C, mA, mV; of each turn the time in 0.1 ms and the output in 0.01 mA.

       host  ?     board  I thermicon 2 DIGEST ICONS WATCHDOG LOW_MA HIGH_MA LOW HIGH HELD_LOW HELD_HIGH HELD REST
       host  B k   begin with the rest of icon k: off, polarity, rest       A B answer of thermicon_begin()
       host  P k   play icon k                                              A P answer of thermicon_play()
       host  F     the host is alive: nothing else feeds
       host  S     stop                                                     A S 0
       board D time state fault icon place display second goal output voltage        each turn

   Call thermicon_serial_byte() for each byte that comes, and thermicon_serial_step() where you called thermicon_step().
   A second host cannot feed by asking: the watchdog counts from F alone. */
#ifndef THERMICON_SERIAL_H
#define THERMICON_SERIAL_H

#ifdef THERMICON_PLAYER_H
#error "include thermicon_serial.h in place of thermicon_player.h: it makes the watchdog shorter"
#endif
#ifndef THERMICON_WATCHDOG_S
#define THERMICON_WATCHDOG_S 1.0f /* a host that plays live is never silent for longer */
#endif
#include <stdio.h>
#include "thermicon_player.h"
@INCLUDES@

#define THERMICON_COUNT @COUNT@
#define THERMICON_LONGEST_LINE 16
#define THERMICON_NOT_BEGUN 5 /* a state of D before the first B */

typedef struct {
    thermicon_player player;
    thermicon_board wrapped;       /* what the player uses: it also notes the output */
    const thermicon_board *board;
    uint8_t icon, begun, length, is_too_long;
    void (*write)(void *context, const char *line);
    /* Voltage of the module in mV, or NULL where it is not measured. */
    long (*voltage_mV)(void *context);
    char line[THERMICON_LONGEST_LINE];
    float output;
    uint32_t last_us;
    uint64_t total_us;
} thermicon_serial;

/* An icon by its place in THERMICON_NAMES. */
static inline thermicon_icon thermicon_icon_at(unsigned place) {
    switch (place) {
@CASES@
    }
}

static inline int thermicon_serial_measure(void *context, float *display_C) {
    const thermicon_board *board = ((thermicon_serial *)context)->board;
    return board->measure(board->context, display_C);
}

static inline int thermicon_serial_measure_second(void *context, float *display_C) {
    const thermicon_board *board = ((thermicon_serial *)context)->board;
    return board->measure_second(board->context, display_C);
}

static inline void thermicon_serial_put_out(void *context, float command) {
    thermicon_serial *serial = (thermicon_serial *)context;
    serial->output = command;
    serial->board->put_out(serial->board->context, command);
}

static inline uint32_t thermicon_serial_now_us(void *context) {
    const thermicon_board *board = ((thermicon_serial *)context)->board;
    return board->now_us(board->context);
}

static inline void thermicon_serial_mark(void *context, int on) {
    const thermicon_board *board = ((thermicon_serial *)context)->board;
    board->mark(board->context, on);
}

static inline uint16_t thermicon_crc(const char *text, size_t length) {
    uint16_t crc = 0;
    size_t k;
    int bit;
    for (k = 0; k < length; k++) {
        crc = (uint16_t)(crc ^ (uint16_t)((uint8_t)text[k] << 8));
        for (bit = 0; bit < 8; bit++) crc = (uint16_t)(crc & 0x8000u ? ((unsigned)crc << 1) ^ 0x1021u : (unsigned)crc << 1);
    }
    return crc;
}

static inline void thermicon_serial_write(thermicon_serial *serial, char *line, size_t most) {
    size_t length = strlen(line);
    snprintf(line + length, most - length, "*%04X\n", (unsigned)thermicon_crc(line, length));
    serial->write(serial->board->context, line);
}

static inline long thermicon_whole(float value) { return (long)(value + (value < 0.0f ? -0.5f : 0.5f)); }

static inline long thermicon_milli(float value) { return thermicon_whole(1000.0f * value); }

/* The output is off, and stays so until the host asks to begin. */
static inline void thermicon_serial_init(thermicon_serial *serial, const thermicon_board *board,
                                         void (*write)(void *context, const char *line)) {
    memset(serial, 0, sizeof *serial);
    serial->board = board;
    serial->write = write;
    serial->wrapped = *board;
    serial->wrapped.context = serial;
    serial->wrapped.measure = board->measure ? thermicon_serial_measure : NULL;
    serial->wrapped.measure_second = board->measure_second ? thermicon_serial_measure_second : NULL;
    serial->wrapped.put_out = thermicon_serial_put_out;
    serial->wrapped.now_us = board->now_us ? thermicon_serial_now_us : NULL;
    serial->wrapped.mark = board->mark ? thermicon_serial_mark : NULL;
    board->put_out(board->context, 0.0f);
}

static inline void thermicon_serial_identify(thermicon_serial *serial) {
    char line[192];
    float low = serial->board->lowest > THERMICON_LOWEST_A ? serial->board->lowest : THERMICON_LOWEST_A;
    float high = serial->board->highest < THERMICON_HIGHEST_A ? serial->board->highest : THERMICON_HIGHEST_A;
    float watchdog = THERMICON_WATCHDOG_S < THERMICON_JUDGED_WATCHDOG_S ? THERMICON_WATCHDOG_S : THERMICON_JUDGED_WATCHDOG_S;
    snprintf(line, sizeof line, "I thermicon 2 %s %u %ld %ld %ld %ld %ld %ld %ld %ld %ld", THERMICON_DIGEST,
             (unsigned)THERMICON_COUNT, thermicon_milli(watchdog), thermicon_milli(low), thermicon_milli(high),
             thermicon_milli(THERMICON_LOW_C), thermicon_milli(THERMICON_HIGH_C), thermicon_milli(THERMICON_HELD_LOW_C),
             thermicon_milli(THERMICON_HELD_HIGH_C), thermicon_milli(THERMICON_HELD_S), thermicon_milli(THERMICON_REST_S));
    thermicon_serial_write(serial, line, sizeof line);
}

/* Does what a line asks whose checksum is right. */
static inline void thermicon_serial_obey(thermicon_serial *serial) {
    char what = serial->line[0], line[32];
    unsigned icon = serial->line[1] == ' ' ? 0 : THERMICON_COUNT, k;
    int answer = 0;
    for (k = 2; serial->line[k] >= '0' && serial->line[k] <= '9'; k++) icon = 10u * icon + (unsigned)(serial->line[k] - '0');
    if (what == '?') thermicon_serial_identify(serial);
    if (what == 'F' && serial->begun) thermicon_feed(&serial->player);
    if (what == 'S' && serial->begun) thermicon_abort(&serial->player);
    if ((what == 'B' || what == 'P') && icon >= THERMICON_COUNT) return;
    if (what == 'B') {
        answer = (int)thermicon_begin(&serial->player, &serial->wrapped, thermicon_icon_at(icon));
        serial->begun = 1;
    }
    if (what == 'P') answer = serial->begun ? (int)thermicon_play(&serial->player, thermicon_icon_at(icon)) : THERMICON_NOT_RESTED;
    if (what == 'B' || (what == 'P' && answer == THERMICON_OK)) serial->icon = (uint8_t)icon;
    if (what != 'B' && what != 'P' && what != 'S') return;
    snprintf(line, sizeof line, "A %c %d", what, answer);
    thermicon_serial_write(serial, line, sizeof line);
}

/* Takes a byte from the host; a line that is too long, or whose checksum is wrong, is as if it had not come. */
static inline void thermicon_serial_byte(thermicon_serial *serial, char byte) {
    uint8_t length = serial->length;
    char crc[8];
    if (byte != '\n') {
        if (length + 1 < THERMICON_LONGEST_LINE) serial->line[serial->length++] = byte;
        else serial->is_too_long = 1;
        return;
    }
    serial->length = 0;
    if (!serial->is_too_long && length > 5 && serial->line[length - 5] == '*') {
        snprintf(crc, sizeof crc, "*%04X", (unsigned)thermicon_crc(serial->line, (size_t)length - 5u));
        if (!memcmp(crc, serial->line + length - 5, 5)) {
            serial->line[length - 5] = 0;
            thermicon_serial_obey(serial);
        }
    }
    serial->is_too_long = 0;
}

/* One turn, and its row; where the player does not read its sensors, they are read here. */
static inline void thermicon_serial_step(thermicon_serial *serial) {
    const thermicon_player *player = &serial->player;
    const thermicon_board *board = serial->board;
    uint32_t now_us = board->now_us(board->context);
    float display = 0.0f, second = 0.0f;
    char line[112], voltage[16] = "-";
    int state = THERMICON_NOT_BEGUN;
    serial->total_us += now_us - serial->last_us;
    serial->last_us = now_us;
    if (serial->begun) {
        state = (int)thermicon_step(&serial->player);
        display = player->first.reading_C;
        second = player->second.reading_C;
    }
    if (!serial->begun || state == THERMICON_STOPPED) {
        if (board->measure) board->measure(board->context, &display);
        if (board->measure_second) board->measure_second(board->context, &second);
    }
    if (serial->voltage_mV) snprintf(voltage, sizeof voltage, "%ld", serial->voltage_mV(board->context));
    snprintf(line, sizeof line, "D %lu %d %d %u %lu %ld %ld %ld %ld %s", (unsigned long)(serial->total_us / 100u), state,
             (int)player->fault, (unsigned)serial->icon, (unsigned long)player->place, thermicon_milli(display),
             thermicon_milli(second), thermicon_milli(player->goal), thermicon_whole(100000.0f * serial->output), voltage);
    thermicon_serial_write(serial, line, sizeof line);
}

#endif
