!> No contact is seen late although close pairs are chosen only now and then, all are swept alike, and who parts forgets.
!> ranks: 1
program test_close_pairs
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put
  use kinds, only: wp
  use outcome, only: outcome_t
  use solids, only: solids_t
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call head_on(friction=0.0_wp, speed=0.05_wp, gap=[0.001_wp, 0.1_wp], tight=.true., name='without friction')
  call head_on(friction=0.3_wp, speed=0.05_wp, gap=[0.001_wp, 0.1_wp], tight=.true., name='with friction')
  call head_on(friction=0.0_wp, speed=1.0_wp, gap=[0.3_wp, 2.3_wp], tight=.false., name='from beyond the first lists')
  call many_alike(speed=0.05_wp, tight=.true., name='where pairs are tight')
  call many_alike(speed=3.0_wp, tight=.false., name='where those that touch are selected')
  call bystander('none')
  call bystander('spring')
  call parted(way=1.0e-3_wp, tight=.true., name='where pairs are tight')
  call parted(way=2.0e-2_wp, tight=.false., name='where those that touch are selected')
  call finish()
  call stop_ranks()

contains

  !> Two balls, both as fast as any, meet from many distances: their velocities change in the step in which they overlap
  !> first, and not before.
  subroutine head_on(friction, speed, gap, tight, name)
    real(wp), intent(in) :: friction
    real(wp), intent(in) :: speed      !< of each [m/s]
    real(wp), intent(in) :: gap(2)     !< shortest and longest, over the diameter
    logical, intent(in) :: tight       !< whether the pair is, all the time
    character(len=*), intent(in) :: name

    real(wp), parameter :: d = 1.0e-3_wp
    integer, parameter :: distances = 100
    type(solids_t) :: balls
    type(contact_settings_t) :: contact
    type(outcome_t) :: outcome
    real(wp) :: dt, x(3, 2), v(3, 2), width
    integer :: m
    logical :: in_time, as_meant, touched

    contact%stiffness = 200.0_wp
    contact%friction = friction
    in_time = .true.
    as_meant = .true.
    do m = 1, distances
      balls = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, contact)
      width = d*(1 + gap(1) + (gap(2) - gap(1))*m/distances)
      x(:, 1) = [0.003_wp, 0.005_wp, 0.005_wp]
      x(:, 2) = [0.003_wp + width, 0.005_wp, 0.005_wp]
      v = reshape([speed, 0.0_wp, 0.0_wp, -speed, 0.0_wp, 0.0_wp], [3, 2])
      call put(balls, x, v, [d, d])
      dt = 0.2_wp*balls%time_step_limit()
      touched = .false.
      do while (.not. touched .and. .not. outcome%failed())
        associate (s => balls%parcels%state)
          touched = abs(s(1, 2) - s(1, 1)) - dt*speed < d   ! in the middle of the step
          call balls%advance(1, dt, outcome)
          in_time = in_time .and. (touched .eqv. abs(s(5, 1)) < speed*(1 - 1e-12_wp))
          as_meant = as_meant .and. (balls%pairs%tight .or. .not. tight)
        end associate
      end do
    end do
    call expect(in_time .and. .not. outcome%failed(), 'a contact is seen in the step in which it begins '//name)
    call expect(as_meant, 'and close pairs are chosen there '//name)
  end subroutine head_on

  !> Thousands of like pairs in glancing collisions, in several stretches of rows, move alike.
  subroutine many_alike(speed, tight, name)
    real(wp), intent(in) :: speed      !< [m/s]
    logical, intent(in) :: tight       !< how their pairs are close then
    character(len=*), intent(in) :: name

    real(wp), parameter :: d = 1.0e-3_wp, apart = 4.0e-3_wp
    integer, parameter :: side = 14, pairs = side**3
    type(solids_t) :: balls
    type(contact_settings_t) :: contact
    type(outcome_t) :: outcome
    real(wp), allocatable :: x(:,:), v(:,:)
    real(wp) :: first(6), off
    integer :: m, c
    logical :: alike

    contact%stiffness = 200.0_wp
    contact%friction = 0.3_wp
    balls = scene(comm, [side*apart, side*apart, side*apart], 0.0_wp, contact)
    allocate (x(3, 2*pairs), v(3, 2*pairs))
    do m = 0, pairs - 1
      x(:, 2*m + 1) = apart*([modulo(m, side), modulo(m/side, side), m/side**2] + 0.4_wp)
      x(:, 2*m + 2) = x(:, 2*m + 1) + d*[0.8_wp, 0.6_wp, 0.001_wp]
      v(:, 2*m + 1) = [speed, 0.0_wp, 0.0_wp]
      v(:, 2*m + 2) = -v(:, 2*m + 1)
    end do
    call put(balls, x, v, spread(d, 1, 2*pairs))
    call balls%advance(20, balls%time_step_limit(), outcome)
    alike = balls%pairs%tight .eqv. tight
    first = 0.0_wp
    off = 0.0_wp
    associate (p => balls%parcels)
      do c = 1, p%n
        if (p%id(c) == 1) first = p%state([5, 6, 7, 9, 10, 11], c)
      end do
      do c = 1, p%n
        m = merge(1, -1, modulo(int(p%id(c)), 2) == 1)
        off = max(off, norm2(p%state(5:7, c) - m*first(1:3)), norm2(p%state(9:11, c) - first(4:6)))
      end do
    end associate
    call expect(alike .and. .not. outcome%failed() .and. norm2(first(4:6)) > 0.01_wp*speed, 'glancing pairs turn '//name)
    call expect(off < 1e-9_wp*speed, 'pairs alike move alike '//name)
  end subroutine many_alike

  !> A glancing pair does the same whether it is tight, or is selected because of a fast ball that flies by far away.
  subroutine bystander(rolling)
    character(len=*), intent(in) :: rolling

    real(wp), parameter :: speed = 0.05_wp
    real(wp), parameter :: width(3) = [1.0e-3_wp, 1.5e-3_wp, 1.0e-3_wp]  ! balls of one size would not roll on each other
    type(solids_t) :: balls
    type(contact_settings_t) :: contact
    type(outcome_t) :: outcome
    real(wp) :: x(3, 3), v(3, 3), motion(6, 2, 2)
    integer :: n, step, c
    logical :: as_meant

    contact%stiffness = 200.0_wp
    contact%friction = 0.3_wp
    contact%rolling = rolling
    if (rolling /= 'none') contact%rolling_friction = 0.2_wp
    x(:, 1) = 0.005_wp
    x(:, 2) = x(:, 1) + 1.001_wp*sum(width(1:2))/2*[0.8_wp, 0.6_wp, 0.0_wp]
    x(:, 3) = 0.015_wp
    v = 0.0_wp
    v(1, :) = [speed, -speed, 20*speed]
    do step = 12, 40, 28  ! while they touch, and once parted
      as_meant = .true.
      do n = 2, 3
        balls = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
        call put(balls, x(:, :n), v(:, :n), width(:n))
        call balls%advance(step, balls%time_step_limit(), outcome)
        as_meant = as_meant .and. (balls%pairs%tight .eqv. n == 2) .and. .not. outcome%failed()
        associate (p => balls%parcels)
          do c = 1, p%n
            if (p%id(c) < 3) motion(:, p%id(c), n - 1) = p%state([5, 6, 7, 9, 10, 11], c)
          end do
        end associate
      end do
      call expect(as_meant .and. norm2(motion(4:6, 1, 1)) > 0.01_wp*speed, 'a glancing pair turns, rolling: '//rolling)
      call expect(maxval(abs(motion(:, :, 2) - motion(:, :, 1))) < 1e-12_wp*speed, &
                  'and does not mind who flies by, rolling: '//rolling)
    end do
  end subroutine bystander

  !> A glancing pair has a slip while it touches, and none in the step after.
  subroutine parted(way, tight, name)
    real(wp), intent(in) :: way        !< of a ball in a step, over its diameter [-]
    logical, intent(in) :: tight       !< how its pairs are close then
    character(len=*), intent(in) :: name

    real(wp), parameter :: d = 1.0e-3_wp
    type(solids_t) :: balls
    type(contact_settings_t) :: contact
    type(outcome_t) :: outcome
    real(wp) :: x(3, 2), v(3, 2), dt
    logical :: touches, touched, alike

    contact%stiffness = 200.0_wp
    contact%friction = 0.3_wp
    balls = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, contact)
    x(:, 1) = 0.005_wp
    x(:, 2) = x(:, 1) + 1.02_wp*d*[0.8_wp, 0.6_wp, 0.0_wp]
    v = 0.0_wp
    call put(balls, x, v, [d, d])
    dt = balls%time_step_limit()
    balls%parcels%state(5, 1:2) = way*d/dt*[1, -1]
    touched = .false.
    alike = .true.
    do
      call balls%advance(1, dt, outcome)
      associate (z => balls%parcels%state(1:3, 1:2) - 0.5_wp*dt*balls%parcels%state(5:7, 1:2))
        touches = norm2(z(:, 2) - z(:, 1)) < d   ! in the middle of the step, where forces are
        if (outcome%failed() .or. (touched .and. .not. touches)) exit
        if (touches) alike = alike .and. balls%pairs%n == 1 .and. (balls%pairs%tight .eqv. tight)
        touched = touches
      end associate
      if (touched .and. balls%pairs%n > 0) alike = alike .and. balls%pairs%remembers(1)
    end do
    call expect(touched .and. alike .and. .not. outcome%failed(), 'a glancing pair has a slip '//name)
    if (balls%pairs%n > 0) alike = .not. balls%pairs%remembers(1)
    call expect(alike, 'and none once parted '//name)
  end subroutine parted

end program test_close_pairs
