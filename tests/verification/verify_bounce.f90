!> One ball above a floor: its whole path, and how high it bounces.
program verify_bounce
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: finish
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run
  use kinds, only: wp
  use report, only: check_value, point
  use solids, only: solids_t
  use spring_contact, only: spring_contact_t, new_spring_contact
  implicit none

  real(wp), parameter :: radius = 0.1_wp, density = 2600.0_wp, start = 0.5_wp, gravity = 9.80665_wp
  real(wp), parameter :: mass = density*4*pi/3*radius**3
  real(wp), parameter :: stiffnesses(4) = [1.0e4_wp, 2.5e4_wp, 5.0e4_wp, 1.0e5_wp]
  type(communicator_t) :: comm
  integer :: i

  call start_ranks(comm)
  do i = 1, size(stiffnesses)
    call falls(stiffnesses(i))
  end do
  call bounces()
  call finish()
  call stop_ranks()

contains

  !> The ball at rest at `start`.
  function ball(stiffness, restitution) result(solids)
    real(wp), intent(in) :: stiffness, restitution  !< [N/m], [-]
    type(solids_t) :: solids

    type(contact_settings_t) :: contact
    real(wp), parameter :: still(3, 1) = 0.0_wp

    contact%stiffness = stiffness
    contact%restitution = restitution
    solids = scene(comm, [1.0_wp, 1.0_wp, 1.0_wp], -gravity, contact)
    solids%numerics%steps_per_collision = 50
    call put(solids, reshape([0.5_wp, 0.5_wp, start], [3, 1]), still, [2*radius], density=[density])
  end function ball

  !> The worst of elastic falls, and of falls with a restitution of 0.9 to 0.6. The softest floor is left out for the
  !> elastic ball: its centre would sink through it.
  subroutine falls(stiffness)
    real(wp), intent(in) :: stiffness  !< [N/m]

    real(wp) :: error
    integer :: tenths
    character(len=12) :: name

    write (name, '(a,i0)') 'fall_k', nint(stiffness)
    if (stiffness > stiffnesses(1)) call check_value(trim(name)//'_elastic', 1000*fall(stiffness, 1.0_wp), 0.0_wp)
    error = 0
    do tenths = 9, 6, -1
      error = max(error, fall(stiffness, 0.1_wp*tenths))
    end do
    call check_value(trim(name)//'_damped', 1000*error, 0.0_wp)
  end subroutine falls

  !> Half a second from free fall through the contact into the flight after it: the largest distance from the exact
  !> height [m].
  function fall(stiffness, restitution) result(error)
    real(wp), intent(in) :: stiffness, restitution  !< [N/m], [-]
    real(wp) :: error

    type(solids_t) :: solids
    type(spring_contact_t) :: contact
    real(wp) :: dt, exact
    integer :: step
    character(len=24) :: curve

    contact = new_spring_contact(stiffness, mass, restitution, gravity)
    solids = ball(stiffness, restitution)
    write (curve, '(a,i0,a,f3.1)') 'fall_k', nint(stiffness), '_e', restitution
    dt = solids%time_step_limit()
    error = 0
    do step = 1, int(0.5_wp/dt)
      call run(solids, 1, dt)
      exact = height_at(contact, solids%time)
      error = max(error, abs(solids%parcels%state(3, 1) - exact))
      call point(trim(curve), solids%time, solids%parcels%state(3, 1), exact)
    end do
  end function fall

  !> Exact height of the ball's centre, until it falls on the floor again [m].
  pure function height_at(contact, time) result(z)
    type(spring_contact_t), intent(in) :: contact
    real(wp), intent(in) :: time  !< [s]
    real(wp) :: z

    real(wp) :: touch, v, lift, since

    touch = sqrt(2*(start - radius)/gravity)
    v = gravity*touch
    lift = touch + contact%duration(v)
    since = time - lift
    if (time < touch) then
      z = start - gravity*time**2/2
    else if (time < lift) then
      z = radius + contact%height(v, time - touch)
    else
      z = radius + contact%speed(v, lift - touch)*since - gravity*since**2/2
    end if
  end function height_at

  !> Heights of the first bounces for restitutions of 0.9 to 0.5, the worst of all: against the spring's own, and against
  !> those of instantaneous impacts, from which the spring differs by the weight it carries during the contact [%].
  subroutine bounces()
    real(wp) :: error(2)
    integer :: tenths

    error = 0
    do tenths = 9, 5, -1
      error = max(error, bounce_errors(0.1_wp*tenths))
    end do
    call check_value('bounces', 100*error(1), 0.0_wp)
    call check_value('hard_bounces', 100*error(2), 0.0_wp)
  end subroutine bounces

  !> The largest relative errors of six bounces, against the spring's and against r + (h_0 - r) e^(2 n) [-].
  function bounce_errors(restitution) result(error)
    real(wp), intent(in) :: restitution  !< [-]
    real(wp) :: error(2)

    integer, parameter :: count = 6
    real(wp), parameter :: stiffness = 5.0e6_wp
    type(solids_t) :: solids
    type(spring_contact_t) :: contact
    real(wp) :: dt, v, top, exact(2)
    integer :: n
    character(len=3) :: e

    contact = new_spring_contact(stiffness, mass, restitution, gravity)
    solids = ball(stiffness, restitution)
    write (e, '(f3.1)') restitution
    dt = solids%time_step_limit()
    v = sqrt(2*gravity*(start - radius))
    error = 0
    do n = 1, count
      call next_flight(solids, dt, top)
      v = contact%speed(v, contact%duration(v))
      exact = [radius + v**2/(2*gravity), radius + (start - radius)*restitution**(2*n)]
      error = max(error, abs(top/exact - 1))
      call point('bounces_e'//e, real(n, wp), top/exact(2) - 1, exact(1)/exact(2) - 1)
    end do
  end function bounce_errors

  !> Through the next contact into the flight after it, whose height follows from any of its points.
  subroutine next_flight(solids, dt, top)
    type(solids_t), intent(inout) :: solids
    real(wp), intent(in) :: dt    !< [s]
    real(wp), intent(out) :: top  !< of its centre [m]

    do while (solids%parcels%state(3, 1) > radius)
      call run(solids, 1, dt)
    end do
    do while (solids%parcels%state(3, 1) <= radius)
      call run(solids, 1, dt)
    end do
    top = solids%parcels%state(3, 1) + solids%parcels%state(7, 1)**2/(2*gravity)
  end subroutine next_flight

end program verify_bounce
