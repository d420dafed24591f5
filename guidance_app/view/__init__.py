"""What the screen says and shows, decided without a screen: words, numbers, colours, shapes, cameras.

Every function here takes records and returns records; nothing knows viser, a browser or a clock. The console only
assigns what it is given.
"""
