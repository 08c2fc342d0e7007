// Ports of a twin's model, as the bench uses them. `build.py` generates their definitions, so that one compiled bench serves every twin.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

typedef std::vector<uint32_t> Bits;

// Numbers of units, inputs, outputs and memory clients, and words of a token of each input and output.
extern const int UNITS, INPUTS, OUTPUTS, CLIENTS;
extern const size_t in_words[], out_words[];

void reset(bool active);
// Lets a clock edge pass.
void clock_edge();
// Settles the outputs for the inputs of this cycle.
void settle();
bool starts(int unit);
void drive_answered(int unit, uint32_t steps);
void drive_in(int input, bool reserve, bool push, const Bits* bits);
void drive_pop(int output, bool pop);
// Token that the unit computes next, and token that it delivers next.
void drive_pass(int output, const Bits* bits);
void drive_next(int output, const Bits* bits);
void drive_ready(int client, bool ready);
bool lacks_room(int input);
bool push_out(int output);
bool valid_out(int output);
bool reserves_out(int output);
// Returns the names of the fields that differ from the expected token.
std::string compare_out(int output, const Bits& expected);
bool request_of(int client, int64_t& address);
// Waves of the twin, and beside them starts and deliveries of the model. They do nothing in a build without waves.
void open_waves(const char* path);
void drive_model_start(int unit, bool start);
void drive_model_push(int output, bool push, const Bits* bits);
void dump_waves(int64_t cycle);
void close_waves();
