!> Weights and contact diameters of SSW, SSP, DEM and the blends between them.
program test_weighting
  use check, only: expect, expect_close, finish
  use constants, only: pi
  use kinds, only: wp
  use outcome, only: outcome_t
  use parcels_settings, only: parcels_settings_t
  use weighting, only: weighting_t, new_weighting, sphere_volume
  implicit none

  real(wp), parameter :: d(5) = [250.0e-6_wp, 333.3e-6_wp, 500.0e-6_wp, 642.5e-6_wp, 800.0e-6_wp]

  call same_weight()
  call same_size()
  call one_particle_each()
  call blends()
  call refusals()
  call finish()

contains

  !> The weighting of some keys.
  function made(mode, weight, diameter, theta) result(weighting)
    character(len=*), intent(in) :: mode
    real(wp), intent(in) :: weight    !< [-]
    real(wp), intent(in) :: diameter  !< D or d_0 [m]
    real(wp), intent(in) :: theta
    type(weighting_t) :: weighting

    type(parcels_settings_t) :: settings
    type(outcome_t) :: outcome

    settings%weighting = mode
    settings%weight = weight
    settings%diameter = diameter
    settings%reference_diameter = diameter
    settings%blend_exponent = theta
    call new_weighting(settings, weighting, outcome)
    call expect(.not. outcome%failed(), mode//' is accepted')
  end function made

  subroutine same_weight()
    type(weighting_t) :: ssw

    ssw = made('ssw', 27.0_wp, 0.0_wp, 0.0_wp)
    call expect(all(abs(ssw%weight(d) - 27.0_wp) <= 0.0_wp), 'SSW: every weight is W')
    call expect_close(maxval(abs(ssw%collision_diameter(d)/d - 3.0_wp)), 0.0_wp, 1.0e-15_wp, &
                      'SSW: contact diameter is d W^(1/3)')
  end subroutine same_weight

  subroutine same_size()
    real(wp), parameter :: diameter = 1.5526e-3_wp
    type(weighting_t) :: ssp

    ssp = made('ssp', 0.0_wp, diameter, 0.0_wp)
    call expect(all(abs(ssp%collision_diameter(d) - diameter) <= 0.0_wp), 'SSP: every contact diameter is D, bit for bit')
    call expect_close(ssp%weight(250.0e-6_wp), 239.529340900864_wp, 1.0e-14_wp, 'SSP: weight is (D/d)^3')
    call expect_close(maxval(abs(ssp%weight(d)*sphere_volume(d)/sphere_volume(diameter) - 1.0_wp)), 0.0_wp, 1.0e-14_wp, &
                      'SSP: a parcel has the volume of a sphere of diameter D')
    call expect_close(sphere_volume(2.0_wp), 4.0_wp*pi/3.0_wp, 1.0e-15_wp, 'volume of a sphere')
  end subroutine same_size

  !> W = 1 three ways: no bit differs.
  subroutine one_particle_each()
    type(weighting_t) :: dem, ssw, ssp
    integer :: i

    dem = made('dem', 0.0_wp, 0.0_wp, 0.0_wp)
    ssw = made('ssw', 1.0_wp, 0.0_wp, 0.0_wp)
    call expect(all(abs(dem%weight(d) - 1.0_wp) <= 0.0_wp .and. abs(ssw%weight(d) - 1.0_wp) <= 0.0_wp), &
                'DEM and SSW with W = 1: the weight is 1')
    call expect(all(abs(dem%collision_diameter(d) - d) <= 0.0_wp .and. abs(ssw%collision_diameter(d) - d) <= 0.0_wp), &
                'DEM and SSW with W = 1: the contact diameter is d')
    do i = 1, size(d)
      ssp = made('ssp', 0.0_wp, d(i), 0.0_wp)
      call expect(abs(ssp%weight(d(i)) - 1.0_wp) <= 0.0_wp .and. abs(ssp%collision_diameter(d(i)) - d(i)) <= 0.0_wp, &
                  'SSP with D = d: weight 1, contact diameter d')
    end do
  end subroutine one_particle_each

  subroutine blends()
    type(weighting_t) :: low, middle, high, ssp

    low = made('blend', 27.0_wp, 500.0e-6_wp, 0.0_wp)
    middle = made('blend', 27.0_wp, 500.0e-6_wp, 0.5_wp)
    high = made('blend', 27.0_wp, 500.0e-6_wp, 1.0_wp)
    ssp = made('ssp', 0.0_wp, 1500.0e-6_wp, 0.0_wp)
    call expect(all(abs(low%weight(d) - 27.0_wp) <= 0.0_wp), 'blend at theta = 0 is SSW')
    call expect_close(maxval(abs(high%weight(d)/ssp%weight(d) - 1.0_wp)), 0.0_wp, 1.0e-14_wp, &
                      'blend at theta = 1 is SSP with D = d_0 W_0^(1/3)')
    call expect_close(middle%weight(250.0e-6_wp), 27.0_wp*2.0_wp**1.5_wp, 1.0e-14_wp, 'weight W_0 (d_0/d)^(3 theta)')
    call expect_close(middle%collision_diameter(320.0e-6_wp), 1200.0e-6_wp, 1.0e-14_wp, 'contact diameter at theta = 1/2')
    call expect_close(maxval(abs(middle%collision_diameter(d)/(d*middle%weight(d)**(1.0_wp/3.0_wp)) - 1.0_wp)), &
                      0.0_wp, 1.0e-14_wp, 'contact diameter is d W^(1/3) for any theta')
  end subroutine blends

  subroutine refusals()
    type(parcels_settings_t) :: settings
    type(weighting_t) :: weighting
    type(outcome_t) :: outcome(4)

    settings%weighting = 'ssw'
    call new_weighting(settings, weighting, outcome(1))
    settings%weighting = 'ssp'
    call new_weighting(settings, weighting, outcome(2))
    settings%weighting = 'blend'
    call new_weighting(settings, weighting, outcome(3))
    settings%weighting = 'same'
    call new_weighting(settings, weighting, outcome(4))
    call expect(outcome(1)%failed(), 'SSW without a weight is refused')
    call expect(outcome(2)%failed(), 'SSP without a diameter is refused')
    call expect(outcome(3)%failed(), 'a blend without its keys is refused')
    call expect(outcome(4)%failed(), 'an unknown weighting is refused')
  end subroutine refusals

end program test_weighting
