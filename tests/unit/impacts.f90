!> One parcel that meets the floor, and two that meet each other, by Hertz's law: what they go through.
module impacts
  use communicator, only: communicator_t
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run
  use kinds, only: wp
  use solids, only: solids_t
  implicit none
  private
  public :: impact_t, material, mass_of, bounced, met

  real(wp), parameter, public :: rigid = 1.0e30_wp  !< modulus of a wall that does not yield [Pa]
  real(wp), parameter :: start_gap = 1.0e-6_wp      !< over the radius

  type :: impact_t
    real(wp) :: overlap = 0.0_wp   !< largest [m]
    real(wp) :: force = 0.0_wp     !< largest [N]
    real(wp) :: duration = 0.0_wp  !< [s]
    real(wp) :: restitution = 0.0_wp
  end type impact_t

contains

  pure function material(modulus, poisson, restitution, friction) result(contact)
    real(wp), intent(in) :: modulus, poisson, restitution, friction  !< [Pa], [-], [-], [-]
    type(contact_settings_t) :: contact

    contact%law = 'hertz'
    contact%youngs_modulus = modulus
    contact%poisson_ratio = poisson
    contact%restitution = restitution
    contact%friction = friction
  end function material

  pure function mass_of(radius, density)
    real(wp), intent(in) :: radius, density
    real(wp) :: mass_of

    mass_of = density*4*pi/3*radius**3
  end function mass_of

  !> A parcel meets the floor.
  subroutine bounced(comm, r, density, velocity, contact, impact, spin, last)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: r, density, velocity(3)
    type(contact_settings_t), intent(in) :: contact
    type(impact_t), intent(out) :: impact
    real(wp), intent(in), optional :: spin           !< about y, times the radius [m/s]
    real(wp), intent(out), optional :: last(2)       !< velocity along x and spin about y times radius afterwards [m/s]

    type(solids_t) :: ball

    ball = scene(comm, [100*r, 100*r, 10*r], 0.0_wp, contact)
    call put(ball, reshape([50*r, 50*r, (1 + start_gap)*r], [3, 1]), reshape(velocity, [3, 1]), [2*r], density=[density])
    if (present(spin)) ball%parcels%state(10, 1) = spin
    call follow(ball, 1, abs(velocity(3)), mass_of(r, density), impact)
    if (present(last)) last = ball%parcels%state([5, 10], 1)
  end subroutine bounced

  !> Two parcels meet at v.
  function met(comm, r, density, v, contact) result(impact)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: r(2), density, v
    type(contact_settings_t), intent(in) :: contact
    type(impact_t) :: impact

    type(solids_t) :: pair
    real(wp) :: side, m(2)

    side = 20*maxval(r)
    m = [mass_of(r(1), density), mass_of(r(2), density)]
    pair = scene(comm, [side, side, side], 0.0_wp, contact)
    call put(pair, reshape([side/2, side/2, side/2, side/2, side/2, side/2 + (1 + start_gap)*sum(r)], [3, 2]), &
             reshape([0.0_wp, 0.0_wp, v/2, 0.0_wp, 0.0_wp, -v/2], [3, 2]), 2*r, density=[density, density])
    call follow(pair, 2, v, product(m)/sum(m), impact)
  end function met

  !> Take fine steps until the contact is over; parabolas through the records find its ends and extremes well enough.
  subroutine follow(solids, n, v, m, impact)
    type(solids_t), intent(inout) :: solids
    integer, intent(in) :: n       !< parcels
    real(wp), intent(in) :: v, m   !< speed of the approach [m/s], effective mass [kg]
    type(impact_t), intent(out) :: impact

    real(wp) :: dt, gap, before, speed, last, began, ended
    integer :: step

    dt = solids%time_step_limit(v)/100
    began = -1.0_wp
    ended = -1.0_wp
    call gap_and_speed(solids, n, before, last)
    do step = 1, 200000
      call run(solids, 1, dt)
      call gap_and_speed(solids, n, gap, speed)
      impact%overlap = max(impact%overlap, -gap)
      impact%force = max(impact%force, m*(speed - last)/dt)
      if (gap < 0.0_wp .and. began < 0.0_wp) began = solids%time - dt*gap/(gap - before)
      if (gap >= 0.0_wp .and. before < 0.0_wp) ended = solids%time - dt*gap/(gap - before)
      before = gap
      last = speed
      if (ended > 0.0_wp) exit
    end do
    impact%duration = ended - began
    impact%restitution = speed/v
  end subroutine follow

  !> Gap of the two parcels, or of one and the floor, and how fast it grows.
  pure subroutine gap_and_speed(solids, n, gap, speed)
    type(solids_t), intent(in) :: solids
    integer, intent(in) :: n
    real(wp), intent(out) :: gap, speed  !< [m], [m/s]

    associate (s => solids%parcels%state)
      if (n == 1) then
        gap = s(3, 1) - s(4, 1)
        speed = s(7, 1)
      else
        gap = abs(s(3, 2) - s(3, 1)) - s(4, 1) - s(4, 2)
        speed = (s(7, 2) - s(7, 1))*sign(1.0_wp, s(3, 2) - s(3, 1))
      end if
    end associate
  end subroutine gap_and_speed

end module impacts
