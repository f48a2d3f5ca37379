!> How many real particles a parcel stands for, and how wide the parcel is.
!>
!>   W(d) = W_0 (d_0/d)^(3 theta),  d_cgp = d W^(1/3) = W_0^(1/3) d^(1-theta) d_0^theta
!>
!> theta = 0 gives all parcels the same statistical weight (SSW; with W_0 = 1 plain DEM), theta = 1 gives
!> all the same size (SSP; W_0 = 1, d_0 = D: Lu et al., Chem. Eng. Sci. 179 (2018) 53). Parcels of size d are
!> as many as d^(3 theta) p_N(d) says, so that the real particles they stand for follow p_N(d).
module weighting
  use constants, only: pi
  use kinds, only: wp
  use outcome, only: outcome_t, exit_input
  use parcels_settings, only: parcels_settings_t
  implicit none
  private
  public :: weighting_t, new_weighting, sphere_volume

  type :: weighting_t
    real(wp) :: weight_0 = 1.0_wp    !< W_0 [-]
    real(wp) :: diameter_0 = 1.0_wp  !< d_0 [m]
    real(wp) :: theta = 0.0_wp       !< [-]
  contains
    procedure :: weight              !< W of parcels of given sizes
    procedure :: collision_diameter  !< d_cgp of parcels of given sizes
  end type weighting_t

contains

  !> The weighting a case asks for. Fails where one of its keys is missing.
  pure subroutine new_weighting(settings, weighting, outcome)
    type(parcels_settings_t), intent(in) :: settings
    type(weighting_t), intent(out) :: weighting
    type(outcome_t), intent(inout) :: outcome

    select case (settings%weighting)
    case ('dem')
    case ('ssw')
      weighting = weighting_t(settings%weight, 1.0_wp, 0.0_wp)
      if (settings%weight <= 0.0_wp) call outcome%fail(exit_input, "&parcels weighting = 'ssw' needs a weight")
    case ('ssp')
      weighting = weighting_t(1.0_wp, settings%diameter, 1.0_wp)
      if (settings%diameter <= 0.0_wp) call outcome%fail(exit_input, "&parcels weighting = 'ssp' needs a diameter")
    case ('blend')
      weighting = weighting_t(settings%weight, settings%reference_diameter, settings%blend_exponent)
      if (min(settings%weight, settings%reference_diameter) <= 0.0_wp .or. settings%blend_exponent < 0.0_wp) then
        call outcome%fail(exit_input, &
          "&parcels weighting = 'blend' needs a weight, a reference_diameter and a blend_exponent")
      end if
    case default
      call outcome%fail(exit_input, "&parcels weighting = '"//trim(settings%weighting)//"' is not known")
    end select
  end subroutine new_weighting

  !> Real particles per parcel [-]; exactly W_0 for theta = 0, exactly W_0 where d = d_0.
  elemental function weight(self, d)
    class(weighting_t), intent(in) :: self
    real(wp), intent(in) :: d  !< diameter of the real particle [m]
    real(wp) :: weight

    weight = self%weight_0*(self%diameter_0/d)**(3.0_wp*self%theta)
  end function weight

  !> Diameter at which parcels touch [m]; exactly D for SSP, exactly d where the weight is 1 for all.
  elemental function collision_diameter(self, d)
    class(weighting_t), intent(in) :: self
    real(wp), intent(in) :: d  !< diameter of the real particle [m]
    real(wp) :: collision_diameter

    collision_diameter = self%weight_0**(1.0_wp/3.0_wp)*d**(1.0_wp - self%theta)*self%diameter_0**self%theta
  end function collision_diameter

  !> Volume of a sphere [m3].
  elemental function sphere_volume(d) result(volume)
    real(wp), intent(in) :: d  !< diameter [m]
    real(wp) :: volume

    volume = pi/6.0_wp*d**3
  end function sphere_volume

end module weighting
