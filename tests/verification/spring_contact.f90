!> The closed form of a ball on a floor: a mass on a damped spring under gravity while they touch.
!>
!>   s'' = -g - 2 zeta omega s' - omega^2 s,   s(0) = 0,   s'(0) = -v
!>
!> s is the height above first touch. The contact ends where s returns to 0.
module spring_contact
  use constants, only: pi
  use kinds, only: wp
  implicit none
  private
  public :: spring_contact_t, new_spring_contact, damping_ratio

  type :: spring_contact_t
    real(wp) :: omega                   !< of the undamped spring [1/s]
    real(wp) :: zeta                    !< damping over critical damping [-]
    real(wp) :: omega_d                 !< of the damped spring [1/s]
    real(wp) :: gravity                 !< downward [m/s2]
  contains
    procedure :: collision_time
    procedure :: height
    procedure :: speed
    procedure :: duration
  end type spring_contact_t

contains

  pure function new_spring_contact(stiffness, mass, restitution, gravity) result(contact)
    real(wp), intent(in) :: stiffness    !< [N/m]
    real(wp), intent(in) :: mass         !< [kg]
    real(wp), intent(in) :: restitution  !< without gravity [-]
    real(wp), intent(in) :: gravity      !< [m/s2]
    type(spring_contact_t) :: contact

    contact%omega = sqrt(stiffness/mass)
    contact%zeta = damping_ratio(restitution)
    contact%omega_d = contact%omega*sqrt(1 - contact%zeta**2)
    contact%gravity = gravity
  end function new_spring_contact

  !> Damping over critical damping for which a spring without gravity has this restitution [-].
  pure function damping_ratio(restitution) result(zeta)
    real(wp), intent(in) :: restitution
    real(wp) :: zeta

    zeta = -log(restitution)/sqrt(pi**2 + log(restitution)**2)
  end function damping_ratio

  !> Duration of a contact without gravity [s].
  pure function collision_time(self) result(time)
    class(spring_contact_t), intent(in) :: self
    real(wp) :: time

    time = pi/self%omega_d
  end function collision_time

  !> s at a time after first touch at speed v [m].
  pure function height(self, v, time) result(s)
    class(spring_contact_t), intent(in) :: self
    real(wp), intent(in) :: v, time  !< [m/s], [s]
    real(wp) :: s

    real(wp) :: sag, b

    sag = self%gravity/self%omega**2
    b = (self%zeta*self%omega*sag - v)/self%omega_d
    s = exp(-self%zeta*self%omega*time)*(sag*cos(self%omega_d*time) + b*sin(self%omega_d*time)) - sag
  end function height

  !> s' at a time after first touch at speed v [m/s].
  pure function speed(self, v, time) result(rise)
    class(spring_contact_t), intent(in) :: self
    real(wp), intent(in) :: v, time  !< [m/s], [s]
    real(wp) :: rise

    real(wp) :: sag, b, decay

    sag = self%gravity/self%omega**2
    decay = self%zeta*self%omega
    b = (decay*sag - v)/self%omega_d
    rise = exp(-decay*time)*((self%omega_d*b - decay*sag)*cos(self%omega_d*time) &
                             - (self%omega_d*sag + decay*b)*sin(self%omega_d*time))
  end function speed

  !> Time from first touch at speed v to the end of the contact, by bisection [s]; v is so large that it ends.
  pure function duration(self, v) result(time)
    class(spring_contact_t), intent(in) :: self
    real(wp), intent(in) :: v  !< [m/s]
    real(wp) :: time

    real(wp) :: below, above
    integer :: step

    below = 0.9_wp*self%collision_time()
    above = below
    do while (self%height(v, above) <= 0)
      below = above
      above = above + 0.05_wp*self%collision_time()
    end do
    do step = 1, 100
      time = (below + above)/2
      if (self%height(v, time) < 0) then
        below = time
      else
        above = time
      end if
    end do
  end function duration

end module spring_contact
