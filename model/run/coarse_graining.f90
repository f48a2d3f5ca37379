!> Contact laws of parcels from those of the particles they stand for.
!>
!> With l = W^(1/3), the width of a parcel over that of its particle:
!>
!>   constant_modulus   k_cg = l k, so that impacts overlap by the same share of the radius
!>   dissipation        e_cg^2 = 1 - l (1 - e^2), so that a granular gas of parcels cools as that of particles does
!>
!> A spring k of a particle of width d is an elastic modulus of about k/d, which l k over l d leaves as it is: Bierwisch
!> et al., J. Mech. Phys. Solids 57 (2009) 10-31. The rate of dissipation by collisions per volume goes as (1 - e^2)/d:
!> Lun et al., J. Fluid Mech. 140 (1984) 223-256; equal rates at equal temperature give e_cg, which is real for
!> l < 1/(1 - e^2) only. Friction also dissipates, and is not counted: frictional parcels cool too fast.
!>
!> An attraction in contact of l^3 times that of the particles is the same part of the weight:
!>
!>   bond_number        A_cg = l^2 A (F ~ A R),   k_cg = l^(1/3) k (the force that parts Hertz's spheres ~ k^3 R^2)
!>
!> Sakai et al., Adv. Powder Technol. 23 (2012) 673-681. With A_cg and gaps as they are the energy it takes to part two
!> surfaces also goes as the mass. As given (none), k keeps cohesive stress and, with Hertz's law, the speed below which
!> parcels stick: Thakur, Ooi & Ahmadian, Powder Technol. 293 (2016) 130-137, for forces that go as the square of the width.
!>
!> One l serves all parcels: it is that of the mean weight: exactly W^(1/3) for SSW, and D over the width that
!> has the mean volume of the particles for SSP, whose parcels share one width, mass and collision time.
module coarse_graining
  use case, only: case_t
  use case_keys, only: keys_t
  use constants, only: is_set
  use contact_settings, only: contact_settings_t
  use kinds, only: wp
  use outcome, only: outcome_t
  use parcel_plan, only: parcel_plan_t, new_parcel_plan
  use text, only: brief, shown
  implicit none
  private
  public :: scale_contacts

  real(wp), parameter :: closeness = 1.0e-3_wp  !< of l: how far the parcels of two fills may be apart
  real(wp), parameter :: least = 0.01_wp        !< restitution that a dashpot may be asked for

contains

  !> Note what scales the contacts of parcels, if the case asks for it: see contact_pairs. Once for a case that has been declared.
  subroutine scale_contacts(case, keys)
    type(case_t), intent(inout) :: case
    type(keys_t), intent(inout) :: keys

    real(wp) :: l
    logical :: stiffness, restitution, attraction
    character(len=20) :: key

    stiffness = case%contact%stiffness_scaling == 'constant_modulus'
    restitution = case%contact%restitution_scaling == 'dissipation'
    attraction = case%contact%cohesion_scaling == 'bond_number' .and. case%contact%cohesion /= 'none'
    if (.not. (stiffness .or. restitution .or. attraction) .or. keys%problems%count() > 0) return
    key = 'cohesion_scaling'
    if (restitution) key = 'restitution_scaling'
    if (stiffness) key = 'stiffness_scaling'
    call find_coarseness(case, trim(key), keys)
    if (.not. is_set(case%contact%coarseness)) return
    l = case%contact%coarseness
    if (restitution) call check_restitutions(case, keys)
  end subroutine scale_contacts

  !> l, the same for all fills.
  subroutine find_coarseness(case, key, keys)
    type(case_t), intent(inout) :: case
    character(len=*), intent(in) :: key  !< that asks for it
    type(keys_t), intent(inout) :: keys

    type(parcel_plan_t) :: plan
    type(outcome_t) :: outcome
    real(wp) :: l
    integer :: i

    do i = 1, size(case%fills)
      call new_parcel_plan(case, i, plan, outcome)
      if (outcome%failed()) return
      if (.not. plan%known) then
        call keys%require_at(.false., 'contact', 1, trim(key), 'needs the weight of all parcels, but those of &fill(' &
                             //trim(case%fills(i)%id)//') come from a file: give the values of the parcels themselves')
        return
      end if
      l = plan%mean_weight**(1.0_wp/3.0_wp)
      if (i == 1) case%contact%coarseness = l
      if (abs(l - case%contact%coarseness) <= closeness*l) cycle
      call keys%require_at(.false., 'contact', 1, trim(key), 'one contact law cannot serve parcels '//brief(l)//' and ' &
                           //brief(case%contact%coarseness)//' times as wide as their particles')
      return
    end do
  end subroutine find_coarseness

  !> Every restitution that is given must leave one that dissipates as much as is asked for. What follows for other pairs lies
  !> between those.
  subroutine check_restitutions(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    logical :: common
    integer :: i

    associate (c => case%contact)
      common = .not. allocated(c%materials)
      if (.not. common) common = any(c%powder_material == 0) .or. any(.not. is_set(c%materials%restitution))
      if (common) call check_restitution(c%coarseness, 'contact', 1, 'restitution', c%restitution, keys)
      call check_restitution(c%coarseness, 'contact', 1, 'wall_restitution', c%wall_restitution, keys)
      if (.not. allocated(c%materials)) return
      do i = 1, size(c%materials)
        call check_restitution(c%coarseness, 'material', i, 'restitution', c%materials(i)%restitution, keys)
      end do
      do i = 1, size(c%pairs)
        call check_restitution(c%coarseness, 'material_pair', i, 'restitution', c%pairs(i)%restitution, keys)
      end do
    end associate
  end subroutine check_restitutions

  !> Of one record, if it is given there.
  subroutine check_restitution(l, group, i, key, restitution, keys)
    real(wp), intent(in) :: l
    character(len=*), intent(in) :: group, key
    integer, intent(in) :: i
    real(wp), intent(in) :: restitution
    type(keys_t), intent(inout) :: keys

    real(wp) :: widest

    if (.not. is_set(restitution)) return
    if (1 - l*(1 - restitution**2) >= least**2) return
    widest = (1 - least**2)/(1 - restitution**2)
    call keys%require_at(.false., group, i, key, 'no restitution of parcels dissipates as much: they are ' &
                         //brief(l)//' times as wide as their particles, and at most '//brief(widest) &
                         //' times, a weight of '//brief(widest**3)//', is possible')
  end subroutine check_restitution

end module coarse_graining
