// Test bench for a twin: pushes recorded tokens, answers memory requests and pops in recorded cycles, and compares the start of each step,
// the delivery of each token, and every bit.
//
// Its input has a line per fact; `rtl/check` writes it. All cycles count from the first one after the reset.
//   in I CYCLE_OF_RESERVATION CYCLE_OF_DELIVERY BITS     a token of input I
//   out O CYCLE_OF_DELIVERY CYCLE_OF_POP BITS            an expected token of output O; pop -1: never
//   step UNIT CYCLE                                      an expected start
//   answer UNIT CYCLE                                    a step's last answer
//   request CLIENT CYCLE ADDRESS                         an expected memory request
//   ready CLIENT CYCLE VALUE                             credits suffice (1) or not (0) from this cycle on
//   end CYCLE                                            the last cycle
#include "bench.h"
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <sstream>

struct Token {
    int64_t reserve, deliver, pop;
    Bits bits;
};

static Bits parse(const std::string& hex, size_t words) {
    Bits bits(words, 0);
    size_t at = 0;
    for (size_t i = hex.size(); i > 0 && at < words * 8; at++) {
        char digit = hex[--i];
        bits[at / 8] |= uint32_t(digit <= '9' ? digit - '0' : digit - 'a' + 10) << (4 * (at % 8));
    }
    return bits;
}

struct Kind {
    const char* name;
    uint64_t count;
};
static Kind kinds[3] = {{"accept", 0}, {"deliver", 0}, {"bits", 0}};
static int verbose = 4;

static void differ(int kind, int64_t cycle, const std::string& text) {
    kinds[kind].count++;
    if (verbose-- > 0) std::cerr << "cycle " << cycle << ": " << text << "\n";
}

int main(int argc, char** argv) {
    std::vector<std::vector<Token>> in(INPUTS), out(OUTPUTS);
    std::vector<std::vector<int64_t>> steps(UNITS), answers(UNITS);
    std::vector<std::vector<std::pair<int64_t, int64_t>>> requests(CLIENTS);
    std::vector<std::vector<std::pair<int64_t, int>>> ready(CLIENTS);
    int64_t end = 0;
    std::ifstream file(argv[1]);
    std::string line, word, hex;
    while (std::getline(file, line)) {
        std::istringstream s(line);
        size_t number = 0;
        int64_t a = 0, b = 0;
        s >> word;
        if (word == "in") {
            s >> number >> a >> b >> hex;
            in[number].push_back({a, b, -1, parse(hex, in_words[number])});
        } else if (word == "out") {
            s >> number >> a >> b >> hex;
            out[number].push_back({-1, a, b, parse(hex, out_words[number])});
        } else if (word == "step") {
            s >> number >> a;
            steps[number].push_back(a);
        } else if (word == "answer") {
            s >> number >> a;
            answers[number].push_back(a);
        } else if (word == "ready") {
            s >> number >> a >> b;
            ready[number].push_back({a, int(b)});
        } else if (word == "request") {
            s >> number >> a >> b;
            requests[number].push_back({a, b});
        } else if (word == "end") {
            s >> end;
        }
    }
    bool waves = argc > 2;
    if (waves) open_waves(argv[2]);
    reset(true);
    for (int i = 0; i < 3; i++) {
        // A clock edge needs a low clock before it.
        settle();
        clock_edge();
    }
    reset(false);
    std::vector<size_t> reserved(INPUTS), pushed(INPUTS), delivered(OUTPUTS), popped(OUTPUTS), given(OUTPUTS);
    std::vector<size_t> at_ready(CLIENTS), requested(CLIENTS);
    std::vector<char> is_ready(CLIENTS), pops(OUTPUTS);
    std::vector<size_t> step(UNITS), answered(UNITS);
    // Time of the processor, because other benches run beside this one.
    std::clock_t begin = std::clock();
    for (int64_t c = 0; c <= end; c++) {
        for (int i = 0; i < INPUTS; i++) {
            bool reserves = reserved[i] < in[i].size() && in[i][reserved[i]].reserve == c;
            bool pushes = pushed[i] < in[i].size() && in[i][pushed[i]].deliver == c;
            drive_in(i, reserves, pushes, pushes ? &in[i][pushed[i]].bits : nullptr);
            reserved[i] += reserves;
            pushed[i] += pushes;
        }
        for (int u = 0; u < UNITS; u++) {
            while (answered[u] < answers[u].size() && answers[u][answered[u]] <= c) answered[u]++;
            drive_answered(u, answered[u]);
        }
        for (int k = 0; k < CLIENTS; k++) {
            while (at_ready[k] < ready[k].size() && ready[k][at_ready[k]].first <= c) is_ready[k] = ready[k][at_ready[k]++].second;
            drive_ready(k, is_ready[k]);
        }
        for (int o = 0; o < OUTPUTS; o++) {
            pops[o] = popped[o] < out[o].size() && out[o][popped[o]].pop == c;
            drive_pop(o, pops[o]);
            drive_pass(o, given[o] < out[o].size() ? &out[o][given[o]].bits : nullptr);
            drive_next(o, delivered[o] < out[o].size() ? &out[o][delivered[o]].bits : nullptr);
        }
        if (waves) {
            for (int u = 0; u < UNITS; u++) drive_model_start(u, step[u] < steps[u].size() && steps[u][step[u]] == c);
            for (int o = 0; o < OUTPUTS; o++) {
                bool due = delivered[o] < out[o].size() && out[o][delivered[o]].deliver == c;
                drive_model_push(o, due, due ? &out[o][delivered[o]].bits : nullptr);
            }
        }
        settle();
        if (waves) dump_waves(c);
        for (int u = 0; u < UNITS; u++) {
            const std::vector<int64_t>& of = steps[u];
            bool begins = starts(u), expected = step[u] < of.size() && of[step[u]] == c;
            if (begins != expected) {
                differ(0, c, std::string(begins ? "step starts, expected none" : "no step starts, expected one") + ", unit " + std::to_string(u));
                if (begins) while (step[u] < of.size() && of[step[u]] < c) step[u]++;
            }
            if (expected) step[u]++;
        }
        for (int o = 0; o < OUTPUTS; o++) {
            given[o] += reserves_out(o);
            bool pushes = push_out(o), due = delivered[o] < out[o].size() && out[o][delivered[o]].deliver == c;
            if (pushes != due) differ(1, c, std::string(pushes ? "token" : "no token") + " on output " + std::to_string(o));
            if (pushes && delivered[o] < out[o].size()) {
                std::string bad = compare_out(o, out[o][delivered[o]].bits);
                if (!bad.empty()) differ(2, c, "token " + std::to_string(delivered[o]) + " of output " + std::to_string(o) + ": " + bad);
            }
            delivered[o] += pushes;
            if (pops[o]) {
                if (!valid_out(o)) differ(1, c, "nothing to pop on output " + std::to_string(o));
                popped[o]++;
            }
        }
        for (int k = 0; k < CLIENTS; k++) {
            int64_t address = 0;
            bool asks = request_of(k, address), due = requested[k] < requests[k].size() && requests[k][requested[k]].first == c;
            if (asks != due) differ(0, c, std::string(asks ? "request" : "no request") + " of client " + std::to_string(k));
            if (asks && due && address != requests[k][requested[k]].second)
                differ(2, c, "request of client " + std::to_string(k) + " at address " + std::to_string(address) + ", expected " +
                                 std::to_string(requests[k][requested[k]].second));
            requested[k] += due;
        }
        for (int i = 0; i < INPUTS; i++)
            if (lacks_room(i)) differ(0, c, "no room on input " + std::to_string(i));
        clock_edge();
        if (kinds[0].count + kinds[1].count + kinds[2].count > 1000) break;
    }
    if (waves) close_waves();
    double seconds = double(std::clock() - begin + 1) / CLOCKS_PER_SEC;
    for (int u = 0; u < UNITS; u++)
        if (step[u] != steps[u].size()) differ(0, end, std::to_string(steps[u].size() - step[u]) + " steps did not start");
    uint64_t tokens = 0;
    for (int o = 0; o < OUTPUTS; o++) {
        if (delivered[o] != out[o].size()) differ(1, end, std::to_string(delivered[o]) + " tokens on output " + std::to_string(o));
        tokens += out[o].size();
    }
    for (int i = 0; i < INPUTS; i++) tokens += in[i].size();
    printf("%llu %lld %llu %llu %llu %.0f\n", (unsigned long long)tokens, (long long)end + 1, (unsigned long long)kinds[0].count,
           (unsigned long long)kinds[1].count, (unsigned long long)kinds[2].count, (end + 1) / seconds);
    return 0;
}
